#include "actors/timer.hpp"
#include "support/catch.hpp"
#include "support/virtual_world.hpp"

using namespace rubicon;
using test::virtual_world;

namespace {

using probe_actor = caf::typed_actor<caf::reacts_to<timer_expired>>;
using probe_pointer = caf::stateful_actor<timer, probe_actor::base>*;

/// What a test does with the timer when the probe begins, and the expiries the timer accepts.
struct script {
  std::function<void(timer&, probe_pointer)> at_start;
  std::vector<duration> accepted;
  int expiries = 0;
};

probe_actor::behavior_type probe(probe_pointer self, script* what) {
  what->at_start(self->state, self);
  return {[self, what](const timer_expired& x) {
    ++what->expiries;
    if (self->state.accepts(x))
      what->accepted.push_back(now(self).time_since_epoch());
  }};
}

script play(std::function<void(timer&, probe_pointer)> at_start) {
  script what{std::move(at_start), {}, 0};
  virtual_world world;
  world.spawn(probe, &what);
  world.run_for(1min);
  return what;
}

} // namespace

TEST_CASE("a timer wakes its actor at the deadline, once", "[actors][timer]") {
  const auto x = play([](timer& t, probe_pointer self) { t.follow(self, instant(3s)); });
  CHECK(x.accepted == std::vector<duration>{3s});
}

TEST_CASE("a deadline that is past already wakes at once", "[actors][timer]") {
  const auto x = play([](timer& t, probe_pointer self) { t.follow(self, instant(-3s)); });
  CHECK(x.accepted == std::vector<duration>{0s});
}

TEST_CASE("of several deadlines the earliest wakes, and no message is sent for later ones",
          "[actors][timer]") {
  const auto earlier_later = play([](timer& t, probe_pointer self) {
    t.follow(self, instant(3s));
    t.follow(self, instant(5s));
    t.follow(self, std::nullopt);
  });
  CHECK(earlier_later.accepted == std::vector<duration>{3s});
  CHECK(earlier_later.expiries == 1);
  const auto later_earlier = play([](timer& t, probe_pointer self) {
    t.follow(self, instant(5s));
    t.follow(self, instant(3s));
  });
  CHECK(later_earlier.accepted == std::vector<duration>{3s});
  CHECK(later_earlier.expiries == 2);
}

TEST_CASE("a timer that was stopped accepts nothing of its earlier life", "[actors][timer]") {
  const auto stopped = play([](timer& t, probe_pointer self) {
    t.follow(self, instant(3s));
    t.stop();
  });
  CHECK(stopped.accepted.empty());
  CHECK(stopped.expiries == 1);
  const auto again = play([](timer& t, probe_pointer self) {
    t.follow(self, instant(3s));
    t.stop();
    t.follow(self, instant(5s));
  });
  CHECK(again.accepted == std::vector<duration>{5s});
}

TEST_CASE("timers of one actor do not take each other's expiries", "[actors][timer]") {
  timer other(1);
  const auto x = play([&other](timer& t, probe_pointer self) {
    other.follow(self, instant(1s));
    t.follow(self, instant(2s));
  });
  CHECK(x.accepted == std::vector<duration>{2s});
  CHECK(x.expiries == 2);
}
