#include <limits>

#include "support/catch.hpp"
#include "traffic/packet.hpp"
#include "traffic/packet_memory.hpp"

using namespace rubicon;
using namespace rubicon::traffic;

namespace {

const packet sample{mote_id{0x0102}, mote_id{0x0304}, 0x050607080910, instant(0x1112131415161718ns),
                    packet_min};

errc error_of(std::string_view hex) {
  return decode_packet(*from_hex(hex)).error();
}

} // namespace

TEST_CASE("a measuring packet is origin, target, number, time and zeros", "[traffic]") {
  CHECK(to_hex(encode(sample)) == "0102030405060708091011121314151617"
                                  "18");
  auto padded = sample;
  padded.size = packet_min + 3;
  CHECK(to_hex(encode(padded)) == "0102030405060708091011121314151617"
                                  "18000000");
}

TEST_CASE("a measuring packet of each size comes back as it was", "[traffic]") {
  CHECK(packet_min == 18);
  CHECK(packet_max == 114);
  for (auto size = packet_min; size <= packet_max; ++size) {
    auto x = sample;
    x.size = size;
    CHECK(encode(x).size() == size);
    const auto back = decode_packet(encode(x));
    REQUIRE(back);
    CHECK(*back == x);
  }
}

TEST_CASE("a measuring packet holds the extremes of its fields", "[traffic]") {
  for (const auto& x :
       {packet{mote_id{1}, mote_id{1}, 0, instant{}, packet_min},
        packet{mote_id{mote_id_max}, mote_id{mote_id_max}, number_max, instant::max(), packet_max},
        packet{mote_id{1}, broadcast_mote, 1, instant(1ns), packet_min}}) {
    const auto back = decode_packet(encode(x));
    REQUIRE(back);
    CHECK(*back == x);
  }
}

TEST_CASE("a measuring packet that is short, long or says the impossible is refused", "[traffic]") {
  const auto good = encode(sample);
  for (std::size_t size = 0; size < packet_min; ++size)
    CHECK(decode_packet(byte_view(good).first(size)).error() == errc::truncated);
  CHECK(decode_packet(bytes(packet_max + 1)).error() == errc::too_long);
  CHECK(error_of("000000010000000000000000000000000000") == errc::bad_value);   // origin 0
  CHECK(error_of("fffd00010000000000000000000000000000") == errc::bad_value);   // no_mote
  CHECK(error_of("ffff00010000000000000000000000000000") == errc::bad_value);   // from everybody
  CHECK(error_of("000100000000000000000000000000000000") == errc::bad_value);   // target 0
  CHECK(error_of("0001fffe0000000000000000000000000000") == errc::bad_value);   // own_mote
  CHECK(error_of("000100020000000000008000000000000000") == errc::bad_value);   // before the run
  CHECK(error_of("00010002000000000000000000000000000001") == errc::bad_value); // padding
  CHECK(error_of("0001000200000000000000000000000000000100") == errc::bad_value);
}

TEST_CASE("a number is new once on its path", "[traffic]") {
  packet_memory memory;
  const auto note = [&](std::uint64_t number) {
    return memory.note(mote_id{1}, mote_id{2}, number);
  };
  CHECK(note(100) == novelty::fresh);
  CHECK(note(100) == novelty::repeated);
  CHECK(note(102) == novelty::fresh);
  CHECK(note(101) == novelty::fresh); // overtaken
  CHECK(note(101) == novelty::repeated);
  CHECK(note(100) == novelty::repeated);
  CHECK(note(102) == novelty::repeated);
  CHECK(memory.note(mote_id{3}, mote_id{2}, 100) == novelty::fresh); // of another origin
}

TEST_CASE("the window of a path is 64 numbers wide", "[traffic]") {
  packet_memory memory;
  const auto note = [&](std::uint64_t number) {
    return memory.note(mote_id{1}, mote_id{2}, number);
  };
  CHECK(note(1000) == novelty::fresh);
  CHECK(note(1063) == novelty::fresh);
  CHECK(note(1000) == novelty::repeated); // the oldest of the window
  CHECK(note(1001) == novelty::fresh);
  CHECK(note(999) == novelty::repeated); // left behind, new or not
  CHECK(note(1064) == novelty::fresh);   // moves on by one
  CHECK(note(1001) == novelty::repeated);
  CHECK(note(1062) == novelty::fresh);
  CHECK(note(1128) == novelty::fresh); // by a whole window
  CHECK(note(1064) == novelty::repeated);
  CHECK(note(1065) == novelty::fresh);
  CHECK(note(0) == novelty::repeated);
  CHECK(note(number_max) == novelty::fresh);
  CHECK(note(number_max) == novelty::repeated);
}

TEST_CASE("number 0 is like any other", "[traffic]") {
  packet_memory memory;
  CHECK(memory.note(mote_id{1}, mote_id{2}, 0) == novelty::fresh);
  CHECK(memory.note(mote_id{1}, mote_id{2}, 0) == novelty::repeated);
  CHECK(memory.note(mote_id{1}, mote_id{2}, 1) == novelty::fresh);
  CHECK(memory.note(mote_id{1}, mote_id{2}, 0) == novelty::repeated);
}

TEST_CASE("a packet that comes from another last hop has gone in a circle", "[traffic]") {
  packet_memory memory;
  CHECK(memory.note(mote_id{1}, mote_id{2}, 7) == novelty::fresh);
  CHECK(memory.note(mote_id{1}, mote_id{3}, 7) == novelty::returned);
  CHECK(memory.note(mote_id{1}, mote_id{3}, 7) == novelty::repeated);
  CHECK(memory.note(mote_id{1}, mote_id{3}, 8) == novelty::fresh);
  CHECK(memory.note(mote_id{1}, mote_id{2}, 8) == novelty::returned);
}

TEST_CASE("a path far ahead does not make the packets of a slow one old", "[traffic]") {
  packet_memory memory;
  CHECK(memory.note(mote_id{1}, mote_id{2}, 5000) == novelty::fresh);
  CHECK(memory.note(mote_id{1}, mote_id{3}, 7) == novelty::fresh);
  CHECK(memory.note(mote_id{1}, mote_id{3}, 6) == novelty::fresh);
}

TEST_CASE("a memory of paths_max paths takes no further one", "[traffic]") {
  packet_memory memory;
  for (std::size_t i = 0; i < packet_memory::paths_max; ++i) {
    const mote_id origin{static_cast<std::uint16_t>(1 + i / packet_memory::last_hops_max)};
    const mote_id last_hop{static_cast<std::uint16_t>(1 + i % packet_memory::last_hops_max)};
    if (memory.note(origin, last_hop, i) != novelty::fresh)
      FAIL("path " << i);
  }
  CHECK(!memory.note(mote_id{9999}, mote_id{1}, 1));
  CHECK(!memory.note(mote_id{9999}, mote_id{1}, 1));
  CHECK(memory.note(mote_id{1}, mote_id{1}, 1'000'000) == novelty::fresh);
}

TEST_CASE("an origin's packets come over at most last_hops_max last hops", "[traffic]") {
  packet_memory memory;
  for (std::uint16_t i = 1; i <= packet_memory::last_hops_max; ++i)
    CHECK(memory.note(mote_id{1}, mote_id{i}, i) == novelty::fresh);
  CHECK(!memory.note(mote_id{1}, mote_id{100}, 100));
  CHECK(memory.note(mote_id{1}, mote_id{7}, 100) == novelty::fresh);
  CHECK(memory.note(mote_id{2}, mote_id{100}, 100) == novelty::fresh);
}
