#include "mote/join/slot_table.hpp"
#include "mote/vector_slot.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::mote;
using network::slot_run;

namespace {

constexpr mote_id a{2};
constexpr mote_id b{3};
constexpr mote_id c{4};

slot_table table() {
  slot_table x(200s);
  x.set_room(100);
  return x;
}

} // namespace

TEST_CASE("slots do not overlap, and a gap is used again", "[mote][SYN-16]") {
  auto x = table();
  CHECK(x.on_notice(a, 30, {}, instant{}) == std::vector{a});
  CHECK(x.on_notice(b, 20, {}, instant{}) == std::vector{b});
  CHECK(x.slot_of(a) == slot_run{0, 30});
  CHECK(x.slot_of(b) == slot_run{30, 20});
  CHECK(x.used() == 50);
  CHECK(x.on_notice(a, 0, {0, 30}, instant{}) == std::vector{a}); // it sends no more
  CHECK(x.used() == 50);
  CHECK(x.on_notice(c, 31, {}, instant{}) == std::vector{c});
  CHECK(x.slot_of(c) == slot_run{50, 31});
  CHECK(x.on_notice(a, 30, {}, instant{}) == std::vector{a});
  CHECK(x.slot_of(a) == slot_run{0, 30});
  CHECK(x.counters().moved == 0);
}

TEST_CASE("a mote that knows its slot is not notified again, one that does not is",
          "[mote][SYN-16]") {
  auto x = table();
  static_cast<void>(x.on_notice(a, 30, {}, instant{}));
  CHECK(x.on_notice(a, 30, {0, 30}, instant{1s}).empty());
  CHECK(x.on_notice(a, 30, {}, instant{2s}) == std::vector{a}); // the grant was lost
  CHECK(x.on_notice(a, 40, {0, 30}, instant{3s}) == std::vector{a});
  CHECK(x.slot_of(a) == slot_run{0, 40});
}

TEST_CASE("slots are put together where gaps are too short, and who is moved is notified",
          "[mote][SYN-16]") {
  auto x = table();
  static_cast<void>(x.on_notice(a, 30, {}, instant{}));
  static_cast<void>(x.on_notice(b, 30, {}, instant{}));
  static_cast<void>(x.on_notice(a, 0, {0, 30}, instant{}));
  CHECK(x.on_notice(c, 70, {}, instant{}) == std::vector{b, c});
  CHECK(x.slot_of(b) == slot_run{0, 30});
  CHECK(x.slot_of(c) == slot_run{30, 70});
  CHECK(x.counters().moved == 1);
}

TEST_CASE("a tick without room refuses, at its limit it does not", "[mote][SYN-16]") {
  auto x = table();
  CHECK(x.on_notice(a, 101, {}, instant{}) == std::vector{a}); // notified that it has none
  CHECK(x.slot_of(a) == slot_run{});
  CHECK(x.counters().refused == 1);
  CHECK(x.on_notice(a, 100, {}, instant{}) == std::vector{a});
  CHECK(x.on_notice(b, 1, {}, instant{}) == std::vector{b});
  CHECK(x.slot_of(b) == slot_run{});
  x.set_room(50); // the tick has become shorter
  CHECK(x.on_notice(a, 100, {0, 100}, instant{}) == std::vector{a});
  CHECK(x.slot_of(a) == slot_run{});
}

TEST_CASE("a slot is free when its mote has been silent about it for long", "[mote][SYN-16]") {
  auto x = table();
  static_cast<void>(x.on_notice(a, 30, {}, instant{}));
  static_cast<void>(x.on_notice(a, 30, {0, 30}, instant{100s}));
  CHECK(*x.deadline() == instant{300s});
  x.on_time(instant{299s});
  CHECK(x.used() == 30);
  x.on_time(instant{300s});
  CHECK(x.used() == 0);
  CHECK_FALSE(x.deadline());
}

TEST_CASE("a mote's slot holds all its vectors, packet after packet", "[mote][SYN-16]") {
  constexpr std::size_t packet_max = 108;
  const network::access_times standard;
  const vector_flow ten[] = {{10, 1}};
  CHECK(units_of(ten, packet_max, standard) == 4); // 100 of them fit 400 units
  const vector_flow wide{64, 8};                   // 25, 25 and 14 elements
  CHECK(passage(wide, packet_max, standard) ==
        2 * network::passage(106, 8, standard) + network::passage(62, 8, standard));
  CHECK(passage({64, 0}, packet_max, standard) ==
        2 * network::passage_up(106, standard) + network::passage_up(62, standard));
  const vector_flow both[] = {wide, {10, 1}};
  CHECK(units_of(both, packet_max, standard) > units_of({&wide, 1}, packet_max, standard));
  CHECK(units_of({}, packet_max, standard) == 0);
}

TEST_CASE("what medium access adds follows from its rules", "[mote][SYN-16]") {
  const auto& micaz = *radio::find_platform("micaz");
  CHECK(access_of(*radio::find_mac("standard", micaz)) == network::access_times{});
  const auto slow = access_of(*radio::find_mac("cc2420", *radio::find_platform("telosb")));
  CHECK(slow.back_off == 320 * 30518ns);
  CHECK(slow.space == 0ns);
}
