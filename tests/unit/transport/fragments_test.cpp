#include <algorithm>
#include <numeric>

#include "core/numbers/random.hpp"
#include "support/catch.hpp"
#include "transport/fragments.hpp"

namespace rubicon::transport {

namespace {

bytes packet_of(std::size_t size) {
  bytes x(size);
  std::iota(x.begin(), x.end(), std::uint8_t{0});
  return x;
}

constexpr mote_id origin{7};

} // namespace

TEST_CASE("a packet of any length comes together from fragments in any order",
          "[transport][NET-14]") {
  random_stream rng(1);
  for (std::size_t size = 0; size <= 270; ++size) {
    auto fragments = cut(packet_of(size), 40, 9);
    REQUIRE(fragments);
    for (std::size_t i = fragments->size(); i > 1; --i)
      std::swap((*fragments)[i - 1], (*fragments)[rng.below(i)]);
    assembly x;
    for (std::size_t i = 0; i < fragments->size(); ++i) {
      CHECK((*fragments)[i].size() <= 40);
      const auto whole = x.on_fragment(origin, (*fragments)[i], instant{});
      REQUIRE(whole.has_value() == (i + 1 == fragments->size()));
      if (whole)
        CHECK(*whole == packet_of(size));
    }
  }
}

TEST_CASE("a packet that takes too many fragments is not cut", "[transport][NET-14]") {
  CHECK(cut(packet_of(160), 12, 0)->size() == fragments_max);
  CHECK_FALSE(cut(packet_of(161), 12, 0));
}

TEST_CASE("fragments of several packets and origins do not mix", "[transport][NET-14]") {
  assembly x({.packets_max = 4});
  const auto a = *cut(bytes(30, 'a'), 20, 1);
  const auto b = *cut(bytes(30, 'b'), 20, 2);
  const auto c = *cut(bytes(30, 'c'), 20, 1);
  CHECK_FALSE(x.on_fragment(origin, a[0], instant{}));
  CHECK_FALSE(x.on_fragment(origin, b[0], instant{}));
  CHECK_FALSE(x.on_fragment(mote_id{8}, c[0], instant{}));
  CHECK(x.on_fragment(origin, a[1], instant{}) == bytes(30, 'a'));
  CHECK(x.on_fragment(mote_id{8}, c[1], instant{}) == bytes(30, 'c'));
  CHECK(x.on_fragment(origin, b[1], instant{}) == bytes(30, 'b'));
}

TEST_CASE("packets whose fragments stop coming are given up and counted", "[transport][NET-14]") {
  assembly x({.packets_max = 4});
  const auto a = *cut(bytes(30, 'a'), 20, 1);
  CHECK_FALSE(x.on_fragment(origin, a[0], instant{}));
  CHECK_FALSE(x.on_fragment(origin, a[1], instant{11s})); // begins anew
  CHECK(x.counters().incomplete == 1);
  for (std::uint16_t i = 0; i < 4; ++i)
    CHECK_FALSE(x.on_fragment(mote_id{i}, a[0], instant{12s}));
  CHECK(x.counters().incomplete == 2); // the oldest made room
  CHECK_FALSE(x.on_fragment(origin, bytes{}, instant{12s}));
  CHECK_FALSE(x.on_fragment(origin, bytes{0x21, 1, 1}, instant{12s}));
  CHECK_FALSE(x.on_fragment(origin, bytes{0x01, 1}, instant{12s}));
  CHECK(x.counters().malformed == 3);
}

TEST_CASE("a packet is waited for as long as its fragments keep coming", "[transport][NET-14]") {
  assembly x;
  const auto fragments = *cut(bytes(40, 'a'), 20, 1);
  REQUIRE(fragments.size() == 3);
  CHECK_FALSE(x.on_fragment(origin, fragments[0], instant{}));
  CHECK_FALSE(x.on_fragment(origin, fragments[1], instant{9s}));
  CHECK(x.on_fragment(origin, fragments[2], instant{18s}) == bytes(40, 'a'));
}

} // namespace rubicon::transport
