// Several sinks as roots of one collection tree.
#include <algorithm>
#include <set>
#include <vector>

#include "network/am.hpp"
#include "support/catch.hpp"
#include "support/mote_ids.hpp"
#include "support/routed_grid.hpp"
#include "support/seeds.hpp"

namespace rubicon::network {

namespace {

using test::id;
using test::routed_grid;
using test::seeds;
using test::the_sink;

/// Over radio and backbones alike; 64: to nowhere.
unsigned hops_of(routed_grid& x, mote_id from) {
  unsigned hops = 0;
  const auto all = x.motes();
  for (auto at = from; at != the_sink && hops < 64; ++hops) {
    if (std::ranges::find(all, at) == all.end())
      return 64; // it is dead, or none
    at = x.at(at).tree().parent();
  }
  return hops;
}

/// Hops over the radio.
double mean_hops(routed_grid& x, const std::set<mote_id>& further) {
  unsigned sum = 0;
  std::size_t motes = 0;
  for (const auto each : x.motes()) {
    if (each == the_sink || further.contains(each))
      continue;
    ++motes;
    for (auto at = each; at != the_sink && at != no_mote && !further.contains(at); ++sum)
      at = x.at(at).tree().parent();
  }
  return static_cast<double>(sum) / static_cast<double>(motes);
}

/// Each mote sends a packet up, and is sent one. @returns how many have arrived, each once
std::size_t exchanged(routed_grid& x) {
  x.arrived.clear();
  for (const auto each : x.motes()) {
    if (each == the_sink)
      continue;
    const auto octet = static_cast<std::uint8_t>(each.value);
    x.send(each, the_sink, {octet, 1});
    x.run_for(100ms);
    if (x.at(the_sink).room_to(each))
      x.send(the_sink, each, {octet, 2});
    x.run_for(100ms);
  }
  x.run_for(20s);
  std::set<std::pair<mote_id, bytes>> different;
  for (const auto& [where, what] : x.arrived)
    different.emplace(where, what.content);
  CHECK(different.size() == x.arrived.size());
  return different.size();
}

/// Each mote reports every ten seconds.
void run_with_reports(routed_grid& x, duration length) {
  for (duration past{}; past < length; past += 10s) {
    for (const auto each : x.motes())
      if (each != the_sink)
        x.send(each, the_sink, {0});
    x.run_for(10s);
  }
}

bool has_routes(routed_grid& x) {
  return std::ranges::all_of(x.motes(), [&x](mote_id each) {
    return each == the_sink || (x.at(each).tree().has_route() && hops_of(x, each) < 64);
  });
}

} // namespace

TEST_CASE("motes send to the nearest of two sinks, which are roots of one tree",
          "[network][NET-05]") {
  for (std::uint64_t seed = 1; seed <= seeds(20); ++seed) {
    CAPTURE(seed);
    routed_grid alone(8, 1, 0.95, seed);
    alone.run_for(5min);
    routed_grid both(8, 1, 0.95, seed, {id(8)});
    both.run_for(5min);
    REQUIRE(has_routes(both));
    CHECK(both.at(id(7)).tree().root() == the_sink);
    CHECK(both.at(id(8)).tree().parent() == the_sink);
    CHECK(both.at(id(8)).tree().cost() == etx_backbone);
    CHECK(mean_hops(alone, {}) >= 4);
    CHECK(mean_hops(both, {id(8)}) <= 2.5);
    CHECK(exchanged(both) >= 13); // of 14: a unicast is given up now and then
    CHECK(both.backbone(id(8)).counters(serial::backbone_direction::up).arrived > 3);
    CHECK(both.backbone(id(8)).counters(serial::backbone_direction::down).arrived > 3);
  }
}

TEST_CASE("the time comes over a backbone, with its jitter as its doubt", "[network][CLK-01]") {
  routed_grid x(8, 1, 0.95, 3, {id(8)});
  x.run_for(10min);
  for (const auto each : x.motes()) {
    CAPTURE(each.value);
    const auto& clock = x.at(each).clock();
    REQUIRE(clock.synchronised());
    const auto error = std::chrono::abs(clock.at(x.own_time(each)) -
                                        x.at(the_sink).clock().at(x.own_time(the_sink)));
    CHECK(error <= clock.doubt(x.own_time(each)) + std::chrono::microseconds(60));
    CHECK(error < std::chrono::microseconds(1000));
  }
  routed_grid apart(3, 1, 1, 1, {id(3)});
  apart.kill(id(2)); // no stamps but the root's
  apart.run_for(2min);
  const auto& clock = apart.at(id(3)).clock();
  REQUIRE(clock.synchronised());
  CHECK(clock.doubt(apart.own_time(id(3))) >= std::chrono::microseconds(100));
}

TEST_CASE("motes take another route when a further sink dies, and come back with it",
          "[network][NET-05]") {
  for (std::uint64_t seed = 1; seed <= seeds(20); ++seed) {
    CAPTURE(seed);
    routed_grid x(8, 1, 0.95, seed, {id(8)});
    x.run_for(5min);
    x.kill(id(8));
    run_with_reports(x, 2min);
    REQUIRE(has_routes(x));
    CHECK(exchanged(x) >= 11); // of 12
    x.start(id(8));
    run_with_reports(x, 3min);
    REQUIRE(has_routes(x));
    CHECK(mean_hops(x, {id(8)}) <= 2.5);
    CHECK(exchanged(x) >= 13);
  }
}

TEST_CASE("a further sink whose backbone is cut is a mote like others", "[network][NET-05]") {
  for (std::uint64_t seed = 1; seed <= seeds(20); ++seed) {
    CAPTURE(seed);
    routed_grid x(8, 1, 0.95, seed, {id(8)});
    x.run_for(5min);
    x.cut(id(8));
    run_with_reports(x, 2min);
    REQUIRE(has_routes(x));
    CHECK(x.at(id(8)).tree().parent() == id(7));
    CHECK(exchanged(x) >= 13);
    x.backbone(id(8)).repair();
    run_with_reports(x, 20min); // beacons of a settled island are rare
    CHECK(x.at(id(8)).tree().parent() == the_sink);
    CHECK(exchanged(x) >= 13);
  }
}

TEST_CASE("a grid with a sink in each corner is one island", "[network][NET-05]") {
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    const std::vector<mote_id> further{id(5), id(21), id(25)};
    routed_grid x(5, 5, 0.95, seed, further);
    x.run_for(5min);
    REQUIRE(has_routes(x));
    CHECK(mean_hops(x, {further.begin(), further.end()}) <= 2.0);
    CHECK(exchanged(x) >= 46); // of 48
    x.arrived.clear();
    x.perform(the_sink, x.at(the_sink).send_to_all({9}, x.own_time(the_sink)));
    x.run_for(5s);
    CHECK(x.arrived.size() == 24);
  }
}

TEST_CASE("sinks that are in radio range of each other use their backbone alone",
          "[network][NET-05]") {
  routed_grid x(3, 1, 1, 1, {id(2)});
  x.run_for(2min);
  CHECK(x.at(id(2)).tree().cost() == etx_backbone);
  CHECK(x.at(id(2)).counters().beside_backbone > 0);
  CHECK(x.at(the_sink).counters().beside_backbone > 0);
  CHECK(exchanged(x) == 4);
}

} // namespace rubicon::network
