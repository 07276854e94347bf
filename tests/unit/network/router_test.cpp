#include <algorithm>
#include <set>
#include <vector>

#include "network/am.hpp"
#include "network/beacon.hpp"
#include "network/router.hpp"
#include "support/catch.hpp"
#include "support/mote_ids.hpp"
#include "support/routed_grid.hpp"

namespace rubicon::network {

namespace {

using test::id;
using test::routed_grid;
using test::the_sink;

} // namespace

TEST_CASE("an island organises itself: routes up and down, places, one clock",
          "[network][NET-11][CLK-01]") {
  routed_grid x(5, 5, 0.95);
  x.run_for(5min);
  std::chrono::microseconds worst{};
  for (const auto id : x.motes()) {
    CHECK(x.at(id).tree().has_route());
    CHECK(x.at(id).place().place().has_value());
    REQUIRE(x.at(id).clock().synchronised());
    const auto error =
        x.at(id).clock().at(x.own_time(id)) - x.at(the_sink).clock().at(x.own_time(the_sink));
    worst = std::max(worst, std::chrono::abs(error));
  }
  CHECK(worst < std::chrono::microseconds{1000});
}

TEST_CASE("packets go up from everybody and down to everybody", "[network][NET-05]") {
  routed_grid x(5, 5, 0.9);
  x.run_for(2min);
  x.arrived.clear();
  for (std::uint8_t i = 2; i <= 25; ++i) {
    x.send(id(i), the_sink, {i});
    x.run_for(200ms);
  }
  x.run_for(20s);
  std::set<mote_id> origins;
  for (const auto& [where, what] : x.arrived) {
    CHECK(where == the_sink);
    CHECK(what.content == bytes{static_cast<std::uint8_t>(what.origin->value)});
    origins.insert(*what.origin);
  }
  CHECK(origins.size() == 24);
  CHECK(x.arrived.size() == 24);
  x.arrived.clear();
  for (std::uint8_t i = 2; i <= 25; ++i) {
    REQUIRE(x.at(the_sink).room_to(id(i)));
    x.send(the_sink, id(i), {i});
    x.run_for(200ms);
  }
  x.run_for(20s);
  CHECK(x.arrived.size() == 24);
  for (const auto& [where, what] : x.arrived) {
    CHECK_FALSE(what.origin);
    CHECK(what.content == bytes{static_cast<std::uint8_t>(where.value)});
  }
}

TEST_CASE("neighbours reach each other directly, others through the sink", "[network][ADR-01]") {
  routed_grid x(5, 1, 1);
  x.run_for(2min);
  x.arrived.clear();
  x.send(id(4), id(5), {1});
  x.send(id(5), id(3), {2});
  x.run_for(5s);
  REQUIRE(x.arrived.size() == 2);
  CHECK(x.arrived[0].first == id(5));
  CHECK(x.arrived[0].second.origin == id(4));
  CHECK(x.arrived[1].first == the_sink); // whose user sends it down
  x.kill(id(5));
  x.send(id(4), id(5), {3});
  x.run_for(5s);
  CHECK(x.arrived.size() == 3);
  CHECK(x.at(id(4)).counters().detours == 1);
}

TEST_CASE("every mote receives what is sent to all", "[network][ADR-05]") {
  routed_grid x(4, 4, 0.9);
  x.run_for(1min);
  x.arrived.clear();
  x.perform(id(6), x.at(id(6)).send_to_all({9}, x.own_time(id(6))));
  x.run_for(5s);
  CHECK(x.arrived.size() == 15);
}

TEST_CASE("channels open between any two motes of an island", "[network][NET-10][STR-18]") {
  routed_grid x(5, 5, 0.95, 2);
  x.run_for(6min);
  random_stream rng(5);
  for (int i = 0; i < 30; ++i) {
    const auto from = id(1 + static_cast<int>(rng.below(25)));
    const auto to = id(1 + static_cast<int>(rng.below(25)));
    if (from == to)
      continue;
    const auto id = x.connect(from, to);
    x.run_for(15s);
    REQUIRE(x.connected.contains(id));
    auto sent = x.at(from).send_on(id, {42}, departure::in_turn, x.own_time(from));
    REQUIRE(sent.has_value());
    x.perform(from, *std::move(sent));
    x.run_for(2s);
    CHECK(x.received[id] == std::vector<bytes>{{42}});
    x.perform(from, x.at(from).disconnect(id, x.own_time(from)));
    x.run_for(2s);
    for (const auto each : x.motes())
      CHECK(x.at(each).paths().table().empty());
  }
}

TEST_CASE("a settled grid floods for few of its channels, and asks once where a mote is",
          "[network][NET-10][NET-12]") {
  routed_grid x(8, 8, 1);
  x.run_for(10min);
  const auto count = [&x](auto counter) {
    std::uint64_t sum = 0;
    for (const auto each : x.motes())
      sum += counter(x.at(each));
    return sum;
  };
  const auto floods = [&] {
    return count([](const router& r) { return r.paths().counters().floods; });
  };
  const auto questions = [&] {
    return count([](const router& r) { return r.counters().questions; });
  };
  const auto floods_before = floods();
  random_stream rng(5);
  int opened = 0;
  for (int i = 0; i < 60; ++i) {
    const auto from = id(2 + static_cast<int>(rng.below(63)));
    const auto to = id(2 + static_cast<int>(rng.below(63)));
    if (from == to)
      continue;
    const auto try_it = [&] {
      const auto id = x.connect(from, to);
      x.run_for(10s);
      opened += x.connected.contains(id) ? 1 : 0;
      x.perform(from, x.at(from).disconnect(id, x.own_time(from)));
      x.run_for(1s);
    };
    try_it();
    const auto asked = questions();
    try_it();
    CHECK(questions() == asked);
  }
  CHECK(opened >= 110);
  CHECK(static_cast<double>(floods() - floods_before) < 0.05 * opened);
}

TEST_CASE("motes that have just started open channels without a flood", "[network][NET-12]") {
  routed_grid x(6, 6, 0.95, 3);
  x.run_for(10min);
  std::uint64_t floods = 0;
  for (const auto from : {8, 15, 22, 29, 36, 31}) { // one of them an anchor
    const auto to = id(38 - from);
    x.start(id(from));
    x.run_for(3s); // it has a route, and no good links
    const auto counted = [&] {
      std::uint64_t sum = 0;
      for (const auto each : x.motes())
        sum += x.at(each).paths().counters().floods;
      return sum;
    };
    const auto before = counted();
    const auto channel = x.connect(id(from), to);
    x.run_for(15s);
    CHECK(x.connected.contains(channel));
    floods += counted() - before;
    x.run_for(1min);
  }
  CHECK(floods == 0);
}

TEST_CASE("without a route to the sink a place that was known once is good enough",
          "[network][NET-12]") {
  routed_grid x(3, 3, 1);
  x.run_for(8min);
  const auto from = id(9);
  const auto to = id(7);
  const bool was_known = GENERATE(false, true);
  if (was_known) {
    const auto id = x.connect(from, to);
    x.run_for(10s);
    REQUIRE(x.connected.contains(id));
    x.perform(from, x.at(from).disconnect(id, x.own_time(from)));
    x.run_for(11min); // that place must be learnt again by now
  }
  for (const auto each : {1, 2, 3, 4, 5, 6})
    x.kill(id(each));
  x.run_for(30min);
  REQUIRE_FALSE(x.at(from).tree().has_route());
  const auto floods = x.at(from).paths().counters().floods_place_unknown;
  const auto id = x.connect(from, to);
  x.run_for(15s);
  CHECK(x.connected.contains(id)); // by 8
  CHECK(x.at(from).paths().counters().floods_place_unknown == floods + (was_known ? 0 : 1));
}

TEST_CASE("a channel that is given up while its place is requested is not opened",
          "[network][NET-10]") {
  routed_grid x(3, 3, 1);
  x.run_for(2min);
  const auto from = id(9); // who is two hops from the other
  const auto asked = x.at(from).counters().questions;
  const auto channel = x.connect(from, id(3));
  CHECK(x.at(from).counters().questions == asked + 1);
  x.perform(from, x.at(from).disconnect(channel, x.own_time(from)));
  x.run_for(15s);
  CHECK(x.connected.empty());
  for (const auto each : x.motes())
    CHECK(x.at(each).paths().table().empty());
}

TEST_CASE("a relay that dies is replaced", "[network][NET-09]") {
  routed_grid x(3, 3, 1);
  x.run_for(2min);
  x.arrived.clear();
  const auto relay = x.at(id(9)).tree().parent();
  x.kill(relay);
  for (int i = 0; i < 20; ++i) {
    x.send(id(9), the_sink, {1});
    x.run_for(5s);
  }
  CHECK(x.arrived.size() >= 18);
  CHECK(x.at(id(9)).tree().parent() != relay);
}

namespace {

/// A router whose radio sleeps for most of 4 s, with nobody around it.
class alone {
public:
  explicit alone(mote_id self) {
    router_config config;
    config.self = self;
    config.is_sink = self == the_sink;
    config.duty.period = 4s;
    life = router(config, random_stream(1), now);
  }

  void run_for(duration length) {
    const auto end = now + length;
    while (life.deadline() <= end) {
      now = std::max(now, life.deadline());
      take(life.on_time(now));
    }
    now = end;
  }

  void receive(mote_id from, const beacon& x) {
    take(life.on_frame(from, am::beacon, encode(x), now, now));
  }

  router life;
  instant now;
  std::vector<std::pair<instant, beacon>> beacons;
  unsigned in_vain = 0; ///< of them while it rests, which do not ask, or after which it does not
                        ///< listen

private:
  void take(const router_outputs& todo) {
    for (const auto& x : todo) {
      const auto* frame = std::get_if<frame_out>(&x);
      if (frame == nullptr)
        continue;
      beacons.emplace_back(now, *decode_beacon(frame->payload));
      const bool asks = beacons.back().second.clock.doubt == doubt_asks;
      if (life.search().rests() && !(asks && life.search().listens(now + 100ms)))
        ++in_vain;
      static_cast<void>(life.on_sent(frame->token, true, 1, now));
    }
  }
};

} // namespace

TEST_CASE("one who asks for the time is answered twice where it listens for a moment only",
          "[network][CLK-04]") {
  alone x(the_sink);
  x.run_for(4min + 2s); // its rounds come once a minute
  x.beacons.clear();
  beacon asks;
  asks.sequence = 1;
  asks.clock.doubt = doubt_asks;
  x.receive(id(2), asks);
  x.run_for(300ms);
  REQUIRE(x.beacons.size() == 2);
  for (const auto& each : x.beacons)
    CHECK(each.second.clock.root == the_sink);
  CHECK(x.beacons[1].first - x.beacons[0].first >= 40ms); // another frame may lie between
  CHECK(x.now - x.beacons[1].first >= 150ms);             // it listens for so long
}

TEST_CASE("answers outside of the windows are not counted, and take no beacon's place",
          "[network][NRG-01]") {
  const auto numbers_after = [](bool is_asked) {
    alone x(the_sink);
    x.run_for(4min + 2s);
    const auto before = x.beacons.back().second.sequence;
    for (int i = 0; i < 240; ++i) {
      x.run_for(500ms);
      beacon neighbour;
      neighbour.sequence = 1;
      neighbour.clock = *x.life.sync().stamp(x.now);
      if (is_asked)
        neighbour.clock.doubt = doubt_asks;
      x.receive(id(2), neighbour);
    }
    if (is_asked)
      CHECK(x.beacons.size() > 300);
    return x.beacons.back().second.sequence - before;
  };
  const auto calm = numbers_after(false);
  CHECK(calm > 0);
  CHECK(numbers_after(true) == calm);
}

TEST_CASE("who rests from a search listens after each beacon, and asks in it",
          "[network][CLK-04]") {
  alone x(id(2));
  x.run_for(1h);
  CHECK(x.life.search().rests());
  CHECK(x.beacons.size() > 200);
  CHECK(x.in_vain == 0);
}

TEST_CASE("the state of a mote's Network module fits its budget", "[network][SMP-30]") {
  routed_grid x(2, 2, 1);
  CHECK(x.at(id(2)).footprint() < 2320);
}

TEST_CASE("messages of the Network modules keep their layout", "[network][golden]") {
  const std::vector<std::pair<router_message, bytes>> all{
      {user_content{{7, 8}}, {0, 7, 8}},
      {place_report{virtual_coordinates{1, 2, 3}}, {1, 1, 2, 3}},
      {place_report{}, {1, 255, 255, 255}},
      {place_question{mote_id{0x0102}}, {2, 1, 2}},
      {place_answer{mote_id{0x0102}, virtual_coordinates{3, 4, 5}}, {3, 1, 2, 3, 4, 5}},
      {sequence_request{}, {4}},
      {period_request{std::chrono::duration<std::uint16_t>(0x0102)}, {5, 1, 2}},
  };
  for (const auto& [message, octets] : all) {
    CHECK(encode(message) == octets);
    CHECK(*decode_router_message(octets) == message);
  }
  CHECK(decode_router_message({}).error() == errc::truncated);
  CHECK(decode_router_message(bytes{6}).error() == errc::unsupported);
  CHECK(decode_router_message(bytes{2, 1}).error() == errc::truncated);
  CHECK(decode_router_message(bytes{2, 1, 2, 3}).error() == errc::too_long);
}

} // namespace rubicon::network
