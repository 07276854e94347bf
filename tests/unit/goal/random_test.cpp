// Random goals, inputs and times: every goal ends once, whatever happens.
#include <algorithm>
#include <string>
#include <vector>

#include "goal/pursuer.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::goal;
using test::pick;

namespace {

const std::vector<std::string> texts{"a", "b", "1", "2.5", "none", ""};

condition any_condition(random_stream& rng) {
  condition x;
  x.input = rng.chance(0.5) ? "x" : "y";
  if (rng.chance(0.5))
    x.equals = {texts[rng.below(2)]};
  else
    x.above = static_cast<double>(rng.below(3));
  return x;
}

pursuer_config any_config(random_stream& rng) {
  pursuer_config x;
  x.name = "p";
  x.inputs = {{"x", ""}, {"y", ""}};
  x.outputs = {{"out", "0", rng.between(100ms, 5s), rng.chance(0.5) ? 1.0 : 0.0, 10.0}};
  for (std::uint64_t i = 0; i <= rng.below(4); ++i) {
    goal_config goal;
    goal.text = "goal " + std::to_string(i);
    goal.timeout = rng.between(10ms, 20s);
    goal.states.resize(1 + rng.below(4));
    for (auto& state : goal.states) {
      state.name = "s" + std::to_string(rng.below(3));
      state.length = rng.between(1ms, 8s);
      if (rng.chance(0.3))
        state.jitter = rng.between(0s, 3s);
      if (rng.chance(0.2))
        state.failure_rate = 0.3;
      if (rng.chance(0.4))
        state.needs = any_condition(rng);
      if (rng.chance(0.3))
        state.sets = {{"out", "3"}};
    }
    x.goals.push_back(std::move(goal));
  }
  return x;
}

/// Goals that have begun and not ended, in what the outputs report.
struct account {
  std::vector<std::string> open;
  std::uint64_t begun_count = 0;
  std::uint64_t ended_count = 0;
  std::string outcome; ///< newest tuple
  std::string state;

  void add(const outputs& out) {
    for (const auto& x : out) {
      if (const auto* published = std::get_if<publish>(&x)) {
        if (published->key == "p.outcome")
          outcome = published->text;
        if (published->key == "p.state")
          state = published->text;
      } else if (const auto* start = std::get_if<begun>(&x)) {
        open.push_back(start->goal);
        ++begun_count;
        CHECK(open.size() == 1); // the one before has ended
      } else if (const auto* end = std::get_if<ended>(&x)) {
        ++ended_count;
        CHECK(outcome == end->goal + ' ' + std::string(to_string(end->outcome)));
        if (end->cause == goal_cause::unknown)
          continue; // has never begun
        REQUIRE(open == std::vector{end->goal});
        open.clear();
      }
    }
  }
};

} // namespace

TEST_CASE("whatever is wanted and whatever inputs say, every goal has one outcome",
          "[goal][SVC-10]") {
  std::uint64_t by_outcome[3] = {};
  for (std::uint64_t seed = 1; seed <= test::seeds(200); ++seed) {
    CAPTURE(seed);
    random_stream rng(seed);
    const auto config = any_config(rng);
    pursuer core(config, random_stream(seed, "core"));
    account published;
    instant now{};
    std::uint64_t wanted = 0;
    published.add(core.start(now));
    for (int i = 0; i < 300; ++i) {
      now += rng.between(0s, 4s);
      // Wake-ups come in time, and sometimes late.
      while (rng.chance(0.9) && core.deadline() && *core.deadline() <= now)
        published.add(core.on_time(*core.deadline()));
      const auto choice = rng.below(10);
      const source from{peer_id(static_cast<std::int32_t>(1 + rng.below(2))), "t"};
      const auto input = rng.below(2);
      if (choice < 3) {
        ++wanted;
        published.add(core.on_goal("goal " + std::to_string(rng.below(5)), now));
      } else if (choice == 3) {
        published.add(core.on_goal("none", now));
      } else if (choice < 8) {
        published.add(core.on_input(input, from, texts[rng.below(texts.size())], now));
      } else if (choice == 8) {
        core.on_input_gone(input, from);
      } else {
        core.on_reference(input, from);
      }
      published.add(core.on_time(now));
      CHECK((core.open_goals() == 0) == (core.doing() == pursuer::phase::idle));
      CHECK((published.state == "idle") == (core.doing() == pursuer::phase::idle));
      CHECK((published.state == "waiting") == (core.doing() == pursuer::phase::waiting));
      CHECK(published.open.size() == core.open_goals());
      REQUIRE(core.deadline()); // the output's period
      CHECK(*core.deadline() > now);
    }
    // The longest timeout is 20 s: without another word all goals end.
    for (const auto end = now + 20s; *core.deadline() <= end;)
      published.add(core.on_time(*core.deadline()));
    const auto& counted = core.counters();
    CHECK(core.open_goals() == 0);
    CHECK(published.open.empty());
    CHECK(counted.goals == wanted);
    CHECK(counted.goals == counted.succeeded + counted.failed + counted.preempted);
    CHECK(published.ended_count == wanted);
    CHECK(published.begun_count + counted.unknown == wanted);
    by_outcome[0] += counted.succeeded;
    by_outcome[1] += counted.failed;
    by_outcome[2] += counted.preempted;
  }
  for (const auto count : by_outcome) // each was met
    CHECK(count >= 50 * test::seeds(200) / 200);
}
