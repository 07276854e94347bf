#include "network/channels/dead_ends.hpp"
#include "network/channels/flood_offers.hpp"
#include "network/channels/next_mote.hpp"
#include "support/catch.hpp"

namespace rubicon::network {

namespace {

constexpr virtual_coordinates own_spot{4, 4, 4};
constexpr virtual_coordinates near_spot{3, 4, 4};
constexpr virtual_coordinates nearest_spot{2, 4, 4};
constexpr virtual_coordinates side_spot{4, 5, 4};
constexpr virtual_coordinates goal_spot{0, 4, 4};
constexpr mote_id goal_mote{9};

connect_step step_to_goal() {
  connect_step x;
  x.request.destination = goal_mote;
  x.request.place = goal_spot;
  return x;
}

surroundings seen_from_here(std::vector<nearby_mote> motes, std::vector<nearby_mote> heard = {}) {
  surroundings x;
  x.own_place = own_spot;
  x.motes = std::move(motes);
  x.heard = std::move(heard);
  return x;
}

std::optional<mote_id> next_after(const connect_step& x, const surroundings& around) {
  return next_towards_destination(x, around);
}

} // namespace

TEST_CASE("a set-up goes to the good neighbour that is nearest to the destination",
          "[network][channels][NET-10]") {
  auto x = step_to_goal();
  const auto around =
      seen_from_here({{mote_id{2}, near_spot}, {mote_id{3}, nearest_spot}, {mote_id{4}, {}}});
  CHECK(next_after(x, around) == mote_id{3});
  x.tried.push_back(mote_id{3});
  CHECK(next_after(x, around) == mote_id{2});
  x.previous = mote_id{2}; // never back where it comes from
  CHECK_FALSE(next_after(x, around));
}

TEST_CASE("the destination itself comes before all others, unless it did not answer",
          "[network][channels][NET-10]") {
  auto x = step_to_goal();
  const auto around = seen_from_here({{mote_id{3}, nearest_spot}, {goal_mote, {}}});
  CHECK(next_after(x, around) == goal_mote);
  x.tried.push_back(goal_mote);
  CHECK(next_after(x, around) == mote_id{3});
}

TEST_CASE("a neighbour that has just started comes before one that is as far as we are",
          "[network][channels][NET-10]") {
  const auto x = step_to_goal();
  CHECK(next_after(x, seen_from_here({{mote_id{2}, side_spot}}, {{mote_id{3}, near_spot}})) ==
        mote_id{3});
  CHECK(next_after(x, seen_from_here({{mote_id{2}, side_spot}}, {{mote_id{3}, side_spot}})) ==
        mote_id{2});
}

TEST_CASE("a mote that does not know where it is leaves a set-up to its parent",
          "[network][channels][NET-10]") {
  auto x = step_to_goal();
  surroundings around;
  around.parent = mote_id{5};
  CHECK(next_after(x, around) == mote_id{5});
  x.previous = mote_id{5};
  CHECK_FALSE(next_after(x, around));
  x.previous.reset();
  x.request.place.reset(); // then all are asked
  CHECK_FALSE(next_after(x, around));
}

TEST_CASE("a source tries a destination near it before all others are asked",
          "[network][channels][NET-12]") {
  auto x = step_to_goal();
  auto around = seen_from_here({});
  CHECK_FALSE(may_be_near(x, around)); // four hops
  around.own_place = virtual_coordinates{1, 4, 4};
  CHECK(may_be_near(x, around));
  x.tried.push_back(mote_id{2});
  CHECK_FALSE(may_be_near(x, around));
}

TEST_CASE("a flood is said less often once another has passed it on, or many have said it",
          "[network][channels][NET-12]") {
  flood_copies alone;
  flood_copies passed_on;
  passed_on.note(4, 2);
  CHECK(passed_on.rounds() < alone.rounds());
  flood_copies heard; // by motes that did not have it from us
  heard.note(3, 2);
  CHECK(heard.rounds() == alone.rounds());
  heard.note(3, 2);
  CHECK(heard.received() == flood_copies::enough);
  CHECK(heard.rounds() == passed_on.rounds());
}

TEST_CASE("no more floods are remembered than there is room for, and each for its time",
          "[network][channels][NET-12]") {
  flood_offers x(2);
  CHECK_FALSE(x.deadline());
  x.add({mote_id{1}, 1}, {mote_id{2}, {}, instant(2s), {}});
  CHECK_FALSE(x.is_full());
  x.add({mote_id{1}, 2}, {mote_id{3}, {}, instant(1s), {}});
  CHECK(x.is_full());
  CHECK(x.deadline() == instant(1s));
  x.on_time(instant(1s));
  CHECK(x.find({mote_id{1}, 2}) == nullptr);
  const auto taken = x.take_up({mote_id{1}, 1});
  REQUIRE(taken);
  CHECK(taken->previous == mote_id{2});
  CHECK_FALSE(x.take_up({mote_id{1}, 1}));
}

TEST_CASE("of too many dead ends the oldest is forgotten, and each after its time",
          "[network][channels][NET-10]") {
  dead_ends x;
  for (std::uint16_t i = 0; i < dead_ends::count_max; ++i)
    x.add({mote_id{1}, i}, instant(1s * (10 - i)));
  CHECK(x.contains({mote_id{1}, 0}));
  CHECK(x.deadline() == instant(8s));
  x.add({mote_id{1}, 7}, instant(20s));
  CHECK_FALSE(x.contains({mote_id{1}, 0}));
  CHECK(x.contains({mote_id{1}, 7}));
  x.on_time(instant(9s));
  CHECK_FALSE(x.contains({mote_id{1}, 1}));
  CHECK(x.contains({mote_id{1}, 7}));
  x.on_time(instant(20s));
  CHECK_FALSE(x.deadline());
}

} // namespace rubicon::network
