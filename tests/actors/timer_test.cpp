#include "actors/base/timer.hpp"
#include "actors/messages/common.hpp"
#include "support/catch.hpp"
#include "testkit/fixture.hpp"

using namespace rubicon;
using test::fixture;

namespace {

/// Asks the probe to follow another deadline.
using nudge = status_request;
struct probe_interface : takes<timer_expired, nudge> {};
using probe_actor = ref<probe_interface>;

struct probe_state {
  timer first;
  timer second{1};
};
using probe_pointer = scheduler::actor_pointer<probe_state, probe_actor>;

/// What a test does with the timer when the probe begins and when it is nudged, and the expiries
/// that the timer accepts.
struct script {
  std::function<void(timer&, probe_pointer)> at_start;
  std::function<void(timer&, probe_pointer)> at_nudge;
  std::vector<duration> accepted;
  int expiries = 0;
};

probe_actor::behavior_type probe(probe_pointer self, script* what) {
  what->at_start(self->state.first, self);
  return {[self, what](const timer_expired& x) {
            ++what->expiries;
            if (self->state.first.accepts(x))
              what->accepted.push_back(now(self).time_since_epoch());
          },
          [self, what](nudge) { what->at_nudge(self->state.first, self); }};
}

script play(std::function<void(timer&, probe_pointer)> at_start,
            std::function<void(timer&, probe_pointer)> at_nudge = {}) {
  script what{std::move(at_start), std::move(at_nudge), {}, 0};
  fixture world;
  world.spawn(probe, &what);
  world.run_for(1min);
  return what;
}

} // namespace

TEST_CASE("a timer wakes its actor at the deadline, once", "[actors][timer][ACT-01]") {
  const auto x = play([](timer& t, probe_pointer self) { t.follow(self, instant(3s)); });
  CHECK(x.accepted == std::vector<duration>{3s});
}

TEST_CASE("a deadline that is past already wakes at once", "[actors][timer]") {
  const auto x = play([](timer& t, probe_pointer self) { t.follow(self, instant(-3s)); });
  CHECK(x.accepted == std::vector<duration>{0s});
}

TEST_CASE("a deadline that moves takes the one message with it", "[actors][timer]") {
  const auto later = play([](timer& t, probe_pointer self) {
    t.follow(self, instant(3s));
    t.follow(self, instant(5s));
  });
  CHECK(later.accepted == std::vector<duration>{5s});
  CHECK(later.expiries == 1);
  const auto earlier = play([](timer& t, probe_pointer self) {
    t.follow(self, instant(5s));
    t.follow(self, instant(3s));
  });
  CHECK(earlier.accepted == std::vector<duration>{3s});
  CHECK(earlier.expiries == 1);
}

TEST_CASE("a timer that follows no deadline any more sends nothing", "[actors][timer]") {
  const auto x = play([](timer& t, probe_pointer self) {
    t.follow(self, instant(3s));
    t.follow(self, std::nullopt);
  });
  CHECK(x.expiries == 0);
}

TEST_CASE("an expiry that waits in the mailbox is outdated by another deadline",
          "[actors][timer]") {
  const auto x = play(
      [](timer& t, probe_pointer self) {
        self->scheduled_send(self, instant(3s), nudge{});
        t.follow(self, instant(3s)); // its expiry comes right behind the nudge
      },
      [](timer& t, probe_pointer self) { t.follow(self, instant(4s)); });
  CHECK(x.accepted == std::vector<duration>{4s});
  CHECK(x.expiries == 2);
}

TEST_CASE("an expiry that waits in the mailbox is not doubled by its own deadline",
          "[actors][timer]") {
  const auto x = play(
      [](timer& t, probe_pointer self) {
        self->scheduled_send(self, instant(3s), nudge{});
        t.follow(self, instant(3s));
      },
      [](timer& t, probe_pointer self) { t.follow(self, instant(3s)); });
  CHECK(x.accepted == std::vector<duration>{3s});
  CHECK(x.expiries == 1);
}

TEST_CASE("the timer of an actor that ends holds nothing any more", "[actors][timer]") {
  fixture world;
  script what{[](timer& t, probe_pointer self) { t.follow(self, instant(24h)); }, {}, {}, 0};
  auto handle = world.spawn(probe, &what);
  const caf::weak_actor_ptr weak(handle.strong().get());
  post_exit(handle, caf::exit_reason::user_shutdown);
  handle = nullptr;
  world.run_for(1s);
  CHECK(!weak.lock());
}

TEST_CASE("a timer that was stopped accepts nothing of its earlier life", "[actors][timer]") {
  const auto stopped = play([](timer& t, probe_pointer self) {
    t.follow(self, instant(3s));
    t.stop();
  });
  CHECK(stopped.expiries == 0);
  const auto again = play([](timer& t, probe_pointer self) {
    t.follow(self, instant(3s));
    t.stop();
    t.follow(self, instant(5s));
  });
  CHECK(again.accepted == std::vector<duration>{5s});
}

TEST_CASE("timers of one actor do not take each other's expiries", "[actors][timer]") {
  const auto x = play([](timer& t, probe_pointer self) {
    self->state.second.follow(self, instant(1s));
    t.follow(self, instant(2s));
  });
  CHECK(x.accepted == std::vector<duration>{2s});
  CHECK(x.expiries == 2);
}
