// Logical processes: whichever runs ahead of which, on however many threads, what happens is the
// same.
#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "core/numbers/random.hpp"
#include "unit/scheduler/support.hpp"

using namespace scheduler_test;

namespace {

constexpr std::size_t places = 6;
constexpr std::size_t actors_each = 5;

struct talker_state {
  random_stream rng;
  std::vector<mark_actor> near;
  std::vector<std::pair<mark_actor, duration>> far; ///< and the delay to each
  mark_actor boss;
  std::uint64_t received = 0;
};

struct talker_interface : extends<mark_interface, introduction> {};
using talker_actor = ref<talker_interface>;
using talker_pointer = actor_pointer<talker_state, talker_actor>;

constexpr int tell_boss = 1'000'000;
constexpr int fall_over = 2'000'000;

/// Sends marks near and far as its dice fall, reports to the boss now and then, and fails on
/// request.
talker_actor::behavior_type talker(talker_pointer self, std::uint64_t seed) {
  self->state.rng = random_stream(seed, self->path());
  return {[self](mark x) {
            auto& state = self->state;
            ++state.received;
            if (x.value == fall_over || state.rng.below(300) == 0)
              throw std::runtime_error("fell over");
            if (x.value > 60)
              return;
            const auto next = mark{x.value + 1};
            const auto what = state.rng.below(10);
            if (what < 3)
              self->delayed_send(self, duration(state.rng.below(3000)), next);
            if (what % 3 == 0)
              self->send(state.near[state.rng.below(state.near.size())], next);
            if (what > 2 && what < 6 && !state.far.empty()) {
              const auto& [to, delay] = state.far[state.rng.below(state.far.size())];
              self->delayed_send(to, delay + duration(state.rng.below(500)), next);
            }
            if (what == 9)
              self->send(state.boss, mark{tell_boss + x.value});
          },
          [self](const introduction& x) {
            if (x.value < 0)
              self->state.near.push_back(x.who);
            else if (x.value == 0)
              self->state.boss = x.who;
            else
              self->state.far.emplace_back(x.who, duration(x.value));
          }};
}

struct boss_state {
  std::vector<talker_actor> all;
  std::vector<std::size_t> where; ///< the place of each
  std::map<caf::actor_addr, std::size_t> numbers;
  std::map<caf::actor_id, mark_actor> ever; ///< the fallen too
  std::vector<process*> processes;
  random_stream rng;
  events log;
  std::uint64_t seed = 0;
};

using boss_pointer = actor_pointer<boss_state, mark_actor>;

void hire(boss_pointer self, std::size_t i) {
  auto& state = self->state;
  auto& place = *state.processes[state.where[i]];
  state.all[i] = spawn_in<monitored>(place, self, "talker/" + std::to_string(i), talker,
                                     state.seed + state.numbers.size());
  state.numbers[state.all[i].address()] = i;
  state.ever[state.all[i].id()] = state.all[i];
  for (std::size_t j = 0; j < state.all.size(); ++j) {
    if (!state.all[j] || i == j)
      continue;
    const auto apart = state.where[i] != state.where[j];
    const auto delay = [](std::size_t from, std::size_t to) {
      return static_cast<int>(100 + 50 * from + 10 * to);
    };
    self->send(state.all[i],
               introduction{apart ? delay(state.where[i], state.where[j]) : -1, state.all[j]});
    self->send(state.all[j],
               introduction{apart ? delay(state.where[j], state.where[i]) : -1, state.all[i]});
  }
  self->send(state.all[i], introduction{-1, state.all[i]});
  self->send(state.all[i], introduction{0, self->handle()});
}

struct outcome {
  std::uint64_t hash = 0;
  std::uint64_t count = 0;
  events log;                          ///< the boss's
  scheduler::world* stopped = nullptr; ///< when the log has
  std::size_t stop_after = 0;          ///< so many entries

  friend bool operator==(const outcome&, const outcome&) = default;
};

/// Places whose actors talk within and across, a boss who starts each round, ends some of them, and
/// hires others for those that have fallen.
mark_actor::behavior_type boss(boss_pointer self, std::uint64_t seed, outcome* result) {
  auto& state = self->state;
  state.seed = seed;
  state.rng = random_stream(seed, "boss");
  auto& scheduler = *coordinator::of(self->system());
  for (std::size_t i = 0; i < places; ++i)
    state.processes.push_back(&scheduler.add_process());
  for (std::size_t i = 0; i < places; ++i)
    for (std::size_t j = 0; j < places; ++j)
      if (i != j)
        scheduler.rounds().link(*state.processes[i], *state.processes[j],
                                duration(100 + 50 * i + 10 * j));
  state.all.resize(places * actors_each);
  for (std::size_t i = 0; i < state.all.size(); ++i) {
    state.where.push_back(i % places);
    hire(self, i);
  }
  self->set_down_handler([self](const caf::down_msg& x) {
    const auto i = self->state.numbers.at(x.source);
    self->state.all[i] = nullptr;
    self->state.log.emplace_back(time_of(self), -static_cast<int>(i));
    self->delayed_send(self, 700ns, mark{-100 - static_cast<int>(i)});
  });
  self->delayed_send(self, 1us, mark{0});
  return {[self, result](mark x) {
    auto& its = self->state;
    its.log.emplace_back(time_of(self), x.value);
    result->log = its.log;
    if (result->stopped != nullptr && its.log.size() == result->stop_after)
      result->stopped->request_stop();
    if (x.value >= tell_boss) {
      // It does something about it, at once and later, at the sender and elsewhere.
      if (x.value % 4 == 0)
        self->send(its.ever.at(self->sender()), mark{50});
      if (x.value % 2 == 0)
        self->send(its.all[its.rng.below(its.all.size())], mark{55});
      if (x.value % 5 == 0)
        self->delayed_send(self, 333ns, mark{-1});
    } else if (x.value <= -100) {
      hire(self, static_cast<std::size_t>(-100 - x.value));
    } else if (x.value >= 0) {
      for (const auto& each : its.all)
        if (each)
          self->send(each, mark{static_cast<int>(its.rng.below(20))});
      const auto& victim = its.all[its.rng.below(its.all.size())];
      if (victim)
        self->send(victim, mark{fall_over});
      if (time_of(self) < 1ms)
        self->delayed_send(self, 20us, mark{0});
    }
  }};
}

outcome run(std::uint64_t seed, unsigned threads, bool in_order, duration step = 1ms) {
  outcome x;
  world world({.threads = threads, .in_order = in_order});
  const auto root = world.spawn("boss", boss, seed, &x);
  for (auto end = instant(step); end <= instant(1ms); end += step)
    world.run_until(end);
  world.run_until(instant(2 * supervision_delay)); // what the boss has others do
  post(root, mark{-1});                            // between runs, and drained
  CHECK(world.drain());
  x.hash = world.trace().hash();
  x.count = world.trace().events();
  return x;
}

mark_actor::behavior_type hasty(counted_pointer self, mark_actor to, bool* refused) {
  self->delayed_send(self, 1ms, mark{0});
  return {[self, to, refused](mark) {
    try {
      self->send(to, mark{1});
    } catch (const std::logic_error&) {
      *refused = true;
    }
  }};
}

/// Adds a process after a while, and sends to who is there.
mark_actor::behavior_type founder(mark_pointer self, events* log) {
  self->delayed_send(self, 1ms, mark{0});
  return {[self, log](mark) {
    auto& added = coordinator::of(self->system())->add_process();
    self->send(spawn_in(added, self, "newcomer", recorder, log, 0), mark{7});
  }};
}

} // namespace

TEST_CASE("what happens does not depend on who runs ahead of whom, nor on the number of threads",
          "[scheduler][GEN-07][NFR-08]") {
  std::set<std::uint64_t> hashes;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const auto expected = run(seed, 1, true); // one event after the other
    REQUIRE(expected.count > 2000);
    REQUIRE(std::ranges::count_if(expected.log, [](const event& x) { return x.second < -1; }) > 10);
    for (const unsigned threads : {1U, 2U, 3U, 8U}) {
      CAPTURE(threads);
      REQUIRE(run(seed, threads, false) == expected);
    }
    REQUIRE(run(seed, 2, false, 100us) == expected); // in steps
    hashes.insert(expected.hash);
  }
  CHECK(hashes.size() == 20);
}

TEST_CASE("a message to another process without the delay of its link is refused",
          "[scheduler][NFR-08]") {
  for (const bool linked : {false, true}) {
    bool refused = false;
    world world;
    auto& here = world.scheduler().add_process();
    auto& there = world.scheduler().add_process();
    if (linked)
      world.scheduler().rounds().link(here, there, 1us);
    const auto place_in = [&](auto& where, auto fun, auto... args) {
      auto handle = make_at(world.system(), where, "actor", fun, args...);
      handle.get().launch(nullptr, false, false);
      return handle;
    };
    const auto to = place_in(there, mute);
    place_in(here, hasty, to, &refused);
    world.run_for(10ms);
    CHECK(refused);
  }
}

TEST_CASE("who is in a process that is added during a run receives what it is sent",
          "[scheduler][NFR-08]") {
  events log;
  world world;
  static_cast<void>(world.scheduler().add_process());
  world.spawn("founder", founder, &log);
  world.run_for(10ms);
  CHECK(log == events{{1ms, 7}});
}

TEST_CASE("in wall time there is one process", "[scheduler][GEN-07]") {
  world world({.mode = time_mode::wall});
  CHECK(&world.scheduler().add_process() == &world.scheduler().supervisor());
}

TEST_CASE("a run that is asked to stop ends at one time for all", "[scheduler][ACT-11]") {
  world world({.threads = 2});
  outcome x;
  const auto root = world.spawn("boss", boss, std::uint64_t{3}, &x);
  world.run_until(instant(100us));
  world.request_stop();
  CHECK(world.run_until(instant(1s)) == stop_cause::requested);
  CHECK(world.now() == instant(100us));
  CHECK(world.run_until(instant(1ms)) == stop_cause::reached_end);
  CHECK(world.drain());
  CHECK(world.trace().hash() == [] {
    outcome y;
    scheduler::world other;
    const auto boss_of_other = other.spawn("boss", boss, std::uint64_t{3}, &y);
    other.run_until(instant(1ms));
    return other.trace().hash();
  }());
}

TEST_CASE("in order a stop comes at the time of the event that requests it, however many threads",
          "[scheduler][GEN-07][NFR-08]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    std::set<instant> ends;
    std::set<std::uint64_t> hashes;
    for (const unsigned threads : {1U, 2U, 3U}) {
      outcome x;
      world world({.threads = threads});
      const auto root = world.spawn("boss", boss, seed, &x);
      world.run_until(instant(500us)); // ahead of each other until here
      world.scheduler().keep_in_order(true);
      x.stopped = &world;
      x.stop_after = x.log.size() + 6;
      REQUIRE(world.run_until(instant(1ms)) == stop_cause::requested);
      CHECK(x.log.back().first == world.now().time_since_epoch());
      ends.insert(world.now());
      CHECK(world.drain());
      hashes.insert(world.trace().hash());
    }
    REQUIRE(ends.size() == 1);
    outcome y;
    world whole;
    const auto root = whole.spawn("boss", boss, seed, &y);
    whole.run_until(*ends.begin());
    hashes.insert(whole.trace().hash());
    CHECK(hashes.size() == 1);
  }
}
