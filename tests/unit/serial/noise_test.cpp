// What a receiver makes of streams that are not clean.
#include <algorithm>
#include <set>

#include "core/numbers/random.hpp"
#include "serial/mote_port.hpp"
#include "support/catch.hpp"
#include "unit/serial/fixture.hpp"

using namespace rubicon;
using namespace rubicon::serial;
using namespace rubicon::serial::test;

namespace {

constexpr std::uint32_t frames_each = 200;

bytes noise(random_stream& rng) {
  bytes out(rng.below(40));
  for (auto& x : out)
    x = static_cast<std::uint8_t>(rng.below(256));
  return out;
}

/// Frames of numbered packets with noise between them, each octet of which may be anything.
bytes noisy_stream(random_stream& rng, frame_type type) {
  bytes wire;
  for (std::uint32_t i = 0; i < frames_each; ++i) {
    const auto between = noise(rng);
    wire.insert(wire.end(), between.begin(), between.end());
    const auto x =
        encode(frame{type, static_cast<std::uint8_t>(i), numbered_packet(i, 4 + i % 25)});
    wire.insert(wire.end(), x.begin(), x.end());
  }
  return wire;
}

/// Each octet is wrong once in a hundred.
void spoil(random_stream& rng, bytes& wire) {
  for (auto& x : wire)
    if (rng.below(100) == 0)
      x = static_cast<std::uint8_t>(x ^ (1 + rng.below(255)));
}

/// The CRC lets one false frame in 65536 through, which is not numbered_packet's to the octet.
bool is_numbered(const bytes& packet, std::set<std::uint32_t>& seen) {
  for (std::uint32_t i = 0; i < frames_each; ++i)
    if (packet == numbered_packet(i, 4 + i % 25))
      return seen.insert(i).second;
  return false;
}

} // namespace

TEST_CASE("of any stream that is mixed with noise only frames that were sent come out",
          "[serial][GW-16]") {
  std::size_t found = 0;
  std::size_t strange = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    random_stream rng(seed);
    auto wire = noisy_stream(rng, frame_type::packet);
    const bool spoiled = seed % 2 == 0;
    if (spoiled)
      spoil(rng, wire);
    std::set<std::uint32_t> seen;
    for (const auto& x : decode_all(wire))
      strange += is_numbered(x.packet, seen) ? 0 : 1;
    found += seen.size();
    CHECK(seen.size() >= frames_each / 3);
  }
  CHECK(strange <= 1);
  CHECK(found >= std::size_t{40} * frames_each / 2);
}

TEST_CASE("a mote's receiver passes up nothing that was not sent either", "[serial][GW-16]") {
  std::size_t strange = 0;
  for (std::uint64_t seed = 101; seed <= 120; ++seed) {
    random_stream rng(seed);
    auto wire = noisy_stream(rng, frame_type::packet_with_ack);
    spoil(rng, wire);
    mote_port mote;
    std::set<std::uint32_t> seen;
    instant now{};
    for (const auto octet : wire) {
      now += 174us;
      for (const auto& x : all<received>(mote.on_bytes(bytes{octet}, now)))
        strange += is_numbered(x.packet, seen) ? 0 : 1;
    }
    CHECK(!seen.empty());
  }
  CHECK(strange <= 1);
}
