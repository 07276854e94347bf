// Virtual coordinates of a whole island.
#include <algorithm>

#include "support/beacon_fixture.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::network;
using namespace rubicon::test;

namespace {

constexpr std::array anchors{anchor_w, anchor_x, anchor_y, anchor_z};

/// Share of the living motes in the sink's reach that agree with it on the anchors, all elected,
/// and whose four distances are the true ones.
double exact_share(const beacon_fixture& world) {
  const auto& sink = world.at(world.sink()).place;
  const auto reach = world.true_hops(world.sink());
  std::vector<std::vector<std::optional<unsigned>>> truth;
  for (const auto x : anchors) {
    if (sink.anchor_id(x) == no_mote)
      return 0;
    truth.push_back(world.true_hops(sink.anchor_id(x)));
  }
  double exact = 0;
  double all = 0;
  for (const auto id : world.all_alive()) {
    const auto& place = world.at(id).place;
    if (!reach[beacon_fixture::index(id)])
      continue;
    ++all;
    exact += std::ranges::all_of(anchors, [&](anchor x) {
      return place.anchor_id(x) == sink.anchor_id(x) &&
             truth[x][beacon_fixture::index(id)] == place.hops_to(x);
    });
  }
  return exact / all;
}

bool is_exact(const beacon_fixture& world) {
  return exact_share(world) == 1;
}

bool converges(beacon_fixture& world, duration limit) {
  return world.run_until_true([&] { return is_exact(world); }, limit);
}

mote_id elected(const beacon_fixture& world, anchor x) {
  return world.at(world.sink()).place.anchor_id(x);
}

/// Of all motes the one with the greatest score, of equals the lowest id.
mote_id farthest(const beacon_fixture& world, auto score) {
  mote_id best = world.all_alive().front();
  for (const auto x : world.all_alive()) {
    if (score(x) > score(best))
      best = x;
  }
  return best;
}

/// Whether X, Y and Z are those of the definition.
bool are_anchors_right(const beacon_fixture& world) {
  const auto hops = [&](anchor a) {
    return [truth = world.true_hops(elected(world, a))](mote_id x) {
      return *truth[beacon_fixture::index(x)];
    };
  };
  const auto w = hops(anchor_w);
  const auto x = hops(anchor_x);
  const auto y = hops(anchor_y);
  return farthest(world, w) == elected(world, anchor_x) &&
         farthest(world, x) == elected(world, anchor_y) &&
         farthest(world, [&](mote_id m) { return std::pair(std::min(x(m), y(m)), x(m) + y(m)); }) ==
             elected(world, anchor_z);
}

beacon_fixture line_fixture(std::size_t size) {
  beacon_fixture world(size);
  for (std::size_t i = 1; i < size; ++i)
    world.set_both(beacon_fixture::id(i - 1), beacon_fixture::id(i), 1);
  return world;
}

} // namespace

TEST_CASE("on a 15 x 15 grid the coordinates are the true hop distances to the anchors",
          "[network][NET-11]") {
  for (const auto sink : {mote_id{1}, mote_id{113}, mote_id{17}}) { // corner, centre, in between
    auto world = grid_fixture(15, 1, 0, sink.value, sink);
    CHECK(converges(world, 220s));
    CHECK(are_anchors_right(world));
    world.run_for(10min);
    CHECK(is_exact(world));
    CHECK(world.at(world.sink()).place.epoch() == 3); // nothing was decided twice
    for (const auto x : world.all_alive()) {
      const auto& place = world.at(x).place;
      REQUIRE(place.place());
      CHECK(place.place()->x == place.hops_to(anchor_x));
      CHECK(place.place()->y == place.hops_to(anchor_y));
      CHECK(place.place()->z == place.hops_to(anchor_z));
    }
  }
}

TEST_CASE("on a lossy 15 x 15 grid the coordinates are exact but for moments",
          "[network][NET-11]") {
  for (std::uint64_t seed = 1; seed <= test::seeds(3); ++seed) {
    auto world = grid_fixture(15, 0.95, 0.3, seed);
    CHECK(converges(world, 300s));
    CHECK(are_anchors_right(world));
    double sum = 0;
    for (int i = 0; i < 60; ++i) {
      world.run_for(10s);
      sum += exact_share(world);
    }
    CAPTURE(seed, sum / 60);
    CHECK(sum / 60 > 0.98);
    CHECK(world.at(world.sink()).place.epoch() == 3);
  }
}

TEST_CASE("beacons become rare when nothing changes", "[network][NET-11]") {
  auto world = grid_fixture(8, 1, 0, 4);
  world.run_for(10min);
  const auto before = world.beacons();
  world.run_for(16min);
  const auto per_mote = static_cast<double>(world.beacons() - before) / 64;
  CHECK(per_mote < 61); // one in 16 s
  CHECK(per_mote > 59);
}

TEST_CASE("coordinates are exact in the smallest islands", "[network][NET-11]") {
  const auto size = GENERATE(1U, 2U, 3U, 4U);
  auto world = line_fixture(size);
  CHECK(converges(world, 5min));
  CHECK(are_anchors_right(world));
  CHECK(world.at(world.sink()).place.place());
}

TEST_CASE("coordinates are exact on a long line, and a link that dies is not counted to infinity",
          "[network][NET-11]") {
  auto world = line_fixture(30);
  REQUIRE(converges(world, 6min));
  CHECK(elected(world, anchor_x) == mote_id{30});
  const auto before = world.at(mote_id{20}).place.hops_to(anchor_w);
  REQUIRE(before == 19);
  world.set_both(mote_id{10}, mote_id{11}, 0);
  unsigned most = 0;
  for (int second = 0; second < 120; ++second) {
    world.run_for(1s);
    const auto hops = world.at(mote_id{20}).place.hops_to(anchor_w);
    most = std::max<unsigned>(most, hops == hops_unknown ? 0 : hops);
  }
  CHECK(most == before);
  CHECK(world.at(mote_id{20}).place.hops_to(anchor_w) == hops_unknown);
  CHECK(world.at(mote_id{20}).place.hops_to(anchor_x) == 10); // still in reach
  CHECK(!world.at(mote_id{10}).place.place());
  CHECK(converges(world, 8min)); // the sink's part, with new anchors
  CHECK(elected(world, anchor_x) == mote_id{10});
  world.set_both(mote_id{10}, mote_id{11}, 1);
  CHECK(world.run_until_true(
      [&] { return elected(world, anchor_x) == mote_id{30} && is_exact(world); }, 10min));
}

TEST_CASE("a mote that has lost an anchor still reports where it was, and no route",
          "[network][NET-11]") {
  auto world = line_fixture(6);
  REQUIRE(converges(world, 6min));
  const auto place = world.at(mote_id{3}).place.place();
  REQUIRE(place == virtual_coordinates{3, 2, 0}); // it is the third anchor itself
  world.set_both(mote_id{3}, mote_id{4}, 0);
  world.run_for(100s);
  const auto& near = world.at(mote_id{2}).place;
  CHECK_FALSE(near.place_of(mote_id{3}));
  CHECK(near.likely_place_of(mote_id{3}) == place);
  CHECK(near.hops_to(anchor_x) == hops_unknown);
  const auto told = coordinates(world.at(mote_id{3}).place).advertise();
  CHECK(told.anchors[anchor_x] ==
        anchor_entry{mote_id{6}, told.anchors[anchor_x].sequence, 3, true});
}

TEST_CASE("who has just started presumes its place from those of its neighbours",
          "[network][NET-10][NET-11]") {
  neighbours links;
  coordinates x({.self = mote_id{9}}, instant{});
  CHECK_FALSE(x.presumed_place());
  const auto beacon = [&](std::uint16_t from, std::array<hop_distance, 3> hops, bool was) {
    coordinates_part part;
    part.epoch = 3;
    part.anchors = {anchor_entry{mote_id{1}, 1, 4}, anchor_entry{mote_id{2}, 1, hops[0], was},
                    anchor_entry{mote_id{3}, 1, hops[1]}, anchor_entry{mote_id{9}, 1, hops[2]}};
    link_report report;
    report.source = mote_id{from};
    static_cast<void>(links.on_beacon(report, instant{}));
    x.on_beacon(mote_id{from}, part, links);
    static_cast<void>(x.update(links, instant{}));
  };
  beacon(4, {7, 2, 1}, false);
  CHECK(x.presumed_place() == virtual_coordinates{8, 3, 0}); // it is an anchor itself
  beacon(5, {5, 4, 1}, true);
  CHECK(x.presumed_place() == virtual_coordinates{6, 3, 0});
  beacon(6, {4, hops_unknown, 1}, false); // does not know where it is
  CHECK(x.presumed_place() == virtual_coordinates{6, 3, 0});
  CHECK_FALSE(x.place());
  CHECK_FALSE(x.likely_place()); // nobody else is told
}

TEST_CASE("a cycle that loses a link measures the route around", "[network][NET-11]") {
  auto world = line_fixture(20);
  world.set_both(mote_id{1}, mote_id{20}, 1);
  REQUIRE(converges(world, 5min));
  CHECK(elected(world, anchor_x) == mote_id{11});
  world.set_both(mote_id{1}, mote_id{20}, 0);
  CHECK(world.run_until_true([&] { return world.at(mote_id{20}).place.hops_to(anchor_w) == 19; },
                             5min));
  CHECK(converges(world, 10min));
}

TEST_CASE("when an anchor dies another is elected", "[network][NET-11]") {
  const auto which = GENERATE(anchor_x, anchor_y, anchor_z);
  auto world = grid_fixture(6, 0.95, 0.3, 9, mote_id{15});
  REQUIRE(converges(world, 5min));
  const auto dead = elected(world, which);
  REQUIRE(dead != world.sink());
  world.kill(dead);
  CHECK(converges(world, 10min));
  CHECK(elected(world, which) != dead);
  CHECK(are_anchors_right(world));
  CHECK(world.at(world.sink()).place.counters().elections == 1);
}

TEST_CASE("a mote that is no anchor may die without an election", "[network][NET-11]") {
  auto world = grid_fixture(6, 1, 0.3, 9);
  REQUIRE(converges(world, 5min));
  world.kill(mote_id{15});
  world.run_for(10min);
  CHECK(is_exact(world));
  CHECK(world.at(world.sink()).place.epoch() == 3);
}

TEST_CASE("a sink or an anchor that restarts goes on with the coordinates there are",
          "[network][NET-11]") {
  auto world = grid_fixture(6, 1, 0.3, 9);
  REQUIRE(converges(world, 5min));
  const auto x = elected(world, anchor_x);
  world.start(world.sink());
  CHECK(converges(world, 90s));
  CHECK(elected(world, anchor_x) == x);
  world.run_for(5min);
  world.start(x);
  CHECK(converges(world, 90s));
  world.run_for(5min);
  CHECK(is_exact(world));
  CHECK(world.at(world.sink()).place.epoch() == 3);
}

TEST_CASE("motes that join late get coordinates; an island that has grown gets new anchors",
          "[network][NET-11]") {
  auto world = line_fixture(12);
  for (std::uint16_t id = 5; id <= 12; ++id)
    world.kill(mote_id{id});
  REQUIRE(converges(world, 5min));
  CHECK(elected(world, anchor_x) == mote_id{4});
  world.start(mote_id{5});
  CHECK(converges(world, 2min));
  world.run_for(5min);
  CHECK(elected(world, anchor_x) == mote_id{4});
  for (std::uint16_t id = 6; id <= 12; ++id)
    world.start(mote_id{id});
  CHECK(world.run_until_true(
      [&] { return elected(world, anchor_x) == mote_id{12} && is_exact(world); }, 8min));
}

TEST_CASE("the greedy step goes to the good neighbour closest to the destination",
          "[network][NET-10]") {
  auto world = grid_fixture(6, 1, 0.3, 4, mote_id{15});
  REQUIRE(converges(world, 5min));
  std::size_t arrived = 0;
  for (const auto from : world.all_alive()) {
    const auto goal = *world.at(mote_id{31}).place.place();
    auto at = from;
    for (auto next = std::optional(from); next;) {
      const auto& mote = world.at(at);
      next = mote.place.greedy_step(goal, mote.links);
      std::optional<mote_id> closest;
      auto least = squared_distance(*mote.place.place(), goal);
      for (const auto& x : mote.links.all()) {
        if (!x.good)
          continue;
        const auto there = squared_distance(*world.at(x.mote).place.place(), goal);
        if (there < least) {
          least = there;
          closest = x.mote;
        }
      }
      REQUIRE(next == closest);
      at = next.value_or(at);
    }
    arrived += at == mote_id{31} ? 1 : 0;
  }
  CHECK(arrived == 36); // a grid without holes has no dead ends
}

TEST_CASE("the four cores together take less than 1.5 KiB of a mote", "[network][NET-10]") {
  const neighbours links;
  const auto capacity = links.config().capacity;
  CHECK(links.footprint() + gradient::footprint(capacity) + coordinates::footprint(capacity) +
            trickle::footprint() <
        1536);
}
