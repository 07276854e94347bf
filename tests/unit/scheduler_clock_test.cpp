#include "unit/scheduler_support.hpp"

using namespace scheduler_test;

namespace {

/// Never answers.
caf::behavior silent(caf::stateful_actor<std::vector<caf::response_promise>>* self) {
  return {[self](mark) { self->state.push_back(self->make_response_promise()); }};
}

/// An actor that does nothing, to set timeouts for.
caf::behavior idle(caf::event_based_actor* self, int* timeouts) {
  self->set_default_handler(caf::drop);
  return {caf::after(60min) >> [=] { ++*timeouts; }};
}

caf::abstract_actor* inside(const caf::actor& x) {
  return caf::actor_cast<caf::abstract_actor*>(x);
}

} // namespace

TEST_CASE("a receive timeout fires after silence and is put off by each message",
          "[scheduler][GEN-07]") {
  world world;
  events log;
  const auto waiting = world.system().spawn([&log](caf::event_based_actor* self) -> caf::behavior {
    return {[self, &log](mark x) { log.emplace_back(time_of(self), x.value); },
            caf::after(10ms) >>
                [self, &log] {
                  log.emplace_back(time_of(self), -1);
                  self->quit();
                }};
  });
  for (const int i : {5, 12, 20})
    caf::delayed_anon_send(waiting, i * 1ms, mark{i});
  world.run_for(1s);
  CHECK(log == events{{5ms, 5}, {12ms, 12}, {20ms, 20}, {30ms, -1}});
}

TEST_CASE("a receive timeout repeats while there is silence", "[scheduler][GEN-07]") {
  world world;
  events log;
  const auto waiting = world.system().spawn([&log](caf::event_based_actor* self) -> caf::behavior {
    return {caf::after(10ms) >> [self, &log] { log.emplace_back(time_of(self), 0); }};
  });
  world.run_for(35ms);
  CHECK(log == events{{10ms, 0}, {20ms, 0}, {30ms, 0}});
}

TEST_CASE("a request without answer ends in an error at its timeout", "[scheduler][GEN-07]") {
  const bool awaited = GENERATE(false, true);
  world world;
  const auto server = world.system().spawn(silent);
  std::vector<std::pair<duration, caf::error>> log;
  const auto client = world.system().spawn([&, awaited](caf::event_based_actor* self) {
    const auto failed = [self, &log](const caf::error& x) { log.emplace_back(time_of(self), x); };
    auto request = self->request(server, 100ms, mark{1});
    if (awaited)
      request.await([](int) { FAIL("nobody answered"); }, failed);
    else
      request.then([](int) { FAIL("nobody answered"); }, failed);
  });
  world.run_for(1s);
  REQUIRE(log.size() == 1);
  CHECK(log[0].first == 100ms);
  CHECK(log[0].second == caf::sec::request_timeout);
}

TEST_CASE("an answer in time silences the request's timeout", "[scheduler][GEN-07]") {
  world world;
  struct promises {
    std::vector<caf::response_promise> open;
  };
  const auto server =
      world.system().spawn([](caf::stateful_actor<promises>* self) -> caf::behavior {
        return {[self](mark) {
                  self->state.open.push_back(self->make_response_promise());
                  self->delayed_send(self, 99ms, static_cast<int>(self->state.open.size()));
                },
                [self](int x) { self->state.open[static_cast<std::size_t>(x - 1)].deliver(x); }};
      });
  std::vector<int> answers;
  int errors = 0;
  const auto client = world.system().spawn([&](caf::event_based_actor* self) -> caf::behavior {
    for (int i = 0; i < 3; ++i)
      self->request(server, 100ms, mark{i})
          .then([&](int x) { answers.push_back(x); }, [&](const caf::error&) { ++errors; });
    return {[](mark) {}};
  });
  world.run_for(1s);
  CHECK(answers == std::vector{1, 2, 3});
  CHECK(errors == 0);
}

TEST_CASE("timeouts can be set, replaced and cancelled one by one", "[scheduler][GEN-07]") {
  world world;
  auto& clock = world.system().clock();
  int timeouts = 0;
  const auto one = world.system().spawn(idle, &timeouts);
  const auto two = world.system().spawn(idle, &timeouts);
  world.run_for(0s);
  clock.cancel_all(); // their own
  const auto t = [](duration x) { return to_clock_time(instant(x)); };
  const auto fired_by = [&](duration x) {
    const auto before = world.stats().timeouts;
    world.run_until(instant(x));
    return world.stats().timeouts - before;
  };

  SECTION("an ordinary timeout replaces the one of the same type only") {
    clock.set_ordinary_timeout(t(1ms), inside(one), caf::atom("a"), 1);
    clock.set_ordinary_timeout(t(5ms), inside(one), caf::atom("a"), 2);
    clock.set_ordinary_timeout(t(2ms), inside(one), caf::atom("b"), 3);
    clock.set_ordinary_timeout(t(2ms), inside(two), caf::atom("a"), 4);
    CHECK(fired_by(1ms) == 0);
    CHECK(fired_by(4ms) == 2);
    CHECK(fired_by(5ms) == 1);
  }
  SECTION("multi timeouts live side by side") {
    for (std::uint64_t i = 0; i < 4; ++i)
      clock.set_multi_timeout(t(2ms), inside(one), caf::atom("a"), i);
    CHECK(fired_by(1ms) == 0);
    CHECK(fired_by(2ms) == 4);
  }
  SECTION("cancelling one ordinary timeout leaves the others") {
    clock.set_ordinary_timeout(t(1ms), inside(one), caf::atom("a"), 1);
    clock.set_ordinary_timeout(t(1ms), inside(one), caf::atom("b"), 2);
    clock.set_multi_timeout(t(1ms), inside(one), caf::atom("a"), 3);
    clock.cancel_ordinary_timeout(inside(one), caf::atom("a"));
    clock.cancel_ordinary_timeout(inside(two), caf::atom("a")); // none: nothing happens
    CHECK(fired_by(1ms) == 2);
  }
  SECTION("cancelling a request's timeout leaves the others") {
    const auto id = [](std::uint64_t x) { return caf::make_message_id(x).response_id(); };
    clock.set_request_timeout(t(1ms), inside(one), id(1));
    clock.set_request_timeout(t(1ms), inside(one), id(2));
    clock.set_request_timeout(t(1ms), inside(two), id(1));
    clock.cancel_request_timeout(inside(one), id(1));
    CHECK(fired_by(1ms) == 2);
  }
  SECTION("cancelling an actor's timeouts leaves other actors' and delayed messages") {
    clock.set_ordinary_timeout(t(1ms), inside(one), caf::atom("a"), 1);
    clock.set_multi_timeout(t(1ms), inside(one), caf::atom("a"), 2);
    clock.set_request_timeout(t(1ms), inside(one), caf::make_message_id(1).response_id());
    clock.set_multi_timeout(t(1ms), inside(two), caf::atom("a"), 3);
    caf::delayed_anon_send(one, 1ms, mark{});
    clock.cancel_timeouts(inside(one));
    CHECK(fired_by(1ms) == 2);
  }
  SECTION("cancelling everything leaves nothing, and new timeouts work") {
    clock.set_ordinary_timeout(t(1ms), inside(one), caf::atom("a"), 1);
    caf::delayed_anon_send(one, 1ms, mark{});
    clock.cancel_all();
    CHECK(!world.scheduler().next_timeout());
    caf::delayed_anon_send(one, 2ms, mark{});
    CHECK(world.scheduler().next_timeout() == instant(2ms));
    CHECK(fired_by(1s) == 1);
  }
}

TEST_CASE("timeouts that alone keep an actor alive can be cancelled", "[scheduler]") {
  world world;
  auto& clock = world.system().clock();
  auto one = world.system().spawn([](counted_pointer self) -> caf::behavior {
    self->set_default_handler(caf::drop);
    return {[](mark) {}};
  });
  world.run_for(0s);
  for (std::uint64_t i = 0; i < 5; ++i)
    clock.set_multi_timeout(to_clock_time(instant(1s)), inside(one), caf::atom("a"), i);
  auto* pointer = inside(one);
  one = nullptr;
  CHECK(counted_state::alive == 1);
  SECTION("one actor's") {
    clock.cancel_timeouts(pointer);
  }
  SECTION("all") {
    clock.cancel_all();
  }
  CHECK(counted_state::alive == 0);
  world.run_for(10s);
  CHECK(world.stats().timeouts == 0);
}

TEST_CASE("a delayed message to a group reaches its members", "[scheduler][GEN-07]") {
  world world;
  events log;
  const auto everybody = world.system().groups().get_local("everybody");
  const auto member = [&log](caf::event_based_actor* self) -> caf::behavior {
    return {[self, &log](mark x) { log.emplace_back(time_of(self), x.value); }};
  };
  const auto one = world.system().spawn_in_group(everybody, member);
  const auto two = world.system().spawn_in_group(everybody, member);
  world.system().clock().schedule_message(to_clock_time(instant(3ms)), everybody, nullptr,
                                          caf::make_message(mark{5}));
  world.run_for(10ms);
  CHECK(log == events{{3ms, 5}, {3ms, 5}});
}

TEST_CASE("ecology time is CAF's time since the epoch", "[scheduler][GEN-07]") {
  world world;
  CHECK(world.system().clock().now().time_since_epoch() == 0s);
  world.run_for(90s);
  CHECK(world.system().clock().now().time_since_epoch() == 90s);
  CHECK(to_instant(world.system().clock().now()) == instant(90s));
  CHECK(to_clock_time(instant(90s)) == world.system().clock().now());
}
