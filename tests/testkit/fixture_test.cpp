#include "actors/base/timer.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"
#include "testkit/fixture.hpp"

using namespace rubicon;
using test::delivery;
using test::fake;
using test::fixture;

namespace {

/// Passes what comes over a cable on to the radio, repeats it after a second, and says so.
struct relay_interface : takes<serial_octets, timer_expired> {};
using relay_actor = ref<relay_interface>;

struct relay_state {
  air_actor air;
  ecology_actor ecology;
  payload newest;
  timer repeat;
};
using relay_pointer = scheduler::actor_pointer<relay_state, relay_actor>;

void pass_on(relay_pointer self) {
  radio_send x;
  x.octets = self->state.newest;
  self->send(self->state.air, x);
}

relay_actor::behavior_type relay(relay_pointer self, air_actor air, ecology_actor ecology) {
  self->state.air = std::move(air);
  self->state.ecology = std::move(ecology);
  self->send(self->state.ecology, notable_event{self->path(), "begins"});
  return {[self](const serial_octets& x) {
            self->state.newest = x.octets;
            pass_on(self);
            self->send(self->state.ecology, notable_event{self->path(), "passed on"});
            self->state.repeat.follow(self, now(self) + 1s);
          },
          [self](const timer_expired& x) {
            if (self->state.repeat.accepts(x))
              pass_on(self);
          }};
}

serial_octets octets(std::uint8_t x) {
  return serial_octets{bytes{x}};
}

struct actor_fixture {
  explicit actor_fixture(delivery when = delivery::when_asked) : world(when) {
    aut = world.spawn_at("relay", relay, air.handle(), ecology.handle());
  }

  fixture world;
  fake<air_actor> air{world, "air"};
  fake<ecology_actor> ecology{world, "ecology"};
  fake<serial_line_actor> line{world, "line"};
  relay_actor aut;
};

bool holds(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

template <class Action>
std::string failure_of(Action action) {
  try {
    action();
  } catch (const test::failure& x) {
    return x.what();
  }
  return {};
}

} // namespace

TEST_CASE("messages are delivered one by one, in the order that the test expects",
          "[testkit][ACT-01]") {
  actor_fixture x;
  CHECK(x.world.expect<notable_event>().from(x.aut).to(x.ecology).what == "begins");
  x.line.send(x.aut, octets(7));
  CHECK(x.air.size() == 0);
  x.world.expect<serial_octets>().from(x.line).to(x.aut);
  CHECK(x.air.size() == 0); // it is on its way
  const auto sent = x.world.expect<radio_send>().from(x.aut).to(x.air);
  CHECK(sent.octets == payload(bytes{7}));
  CHECK(x.air.count<radio_send>() == 1);
  x.world.expect<notable_event>()
      .where([](const notable_event& s) { return s.what == "passed on"; })
      .to(x.ecology);
  x.world.expect_nothing();
}

TEST_CASE("a failed expectation tells what is there instead", "[testkit][ACT-01]") {
  actor_fixture x;
  x.world.run();
  CHECK(failure_of([&] { x.world.expect<radio_send>().from(x.aut).to(x.air); }) ==
        "expected radio_send from relay to air, but nothing is on its way to air");
  x.line.send(x.aut, octets(7));
  const auto another = failure_of([&] { x.world.expect<timer_expired>().to(x.aut); });
  CHECK(another.starts_with("expected timer_expired to relay, but next is "));
  CHECK(holds(another, "serial_octets("));
  CHECK(holds(another, "from line to relay"));
  CHECK(holds(failure_of([&] { x.world.expect<serial_octets>().from(x.air).to(x.aut); }),
              "from air to relay, but next is "));
  CHECK(holds(failure_of([&] {
                x.world.expect<serial_octets>().where([](const auto&) { return false; }).to(x.aut);
              }),
              "its content is not as asked: "));
  CHECK(x.air.size() == 0); // nothing of that has delivered anything
  CHECK(holds(failure_of([&] { x.world.expect_nothing(); }), "from line to relay"));
  x.world.expect<serial_octets>().to(x.aut);
}

TEST_CASE("what should not be sent is a failure, and what may be need not", "[testkit][ACT-01]") {
  actor_fixture x;
  x.world.run();
  x.world.disallow<radio_send>().to_anybody();
  CHECK(!x.world.allow<serial_octets>().to(x.aut));
  x.world.send(x.aut, octets(7));
  x.world.disallow<serial_octets>().from(x.line).to(x.aut); // this one is from nobody
  const auto told = failure_of([&] { x.world.disallow<serial_octets>().to(x.aut); });
  CHECK(told.starts_with("there should be no serial_octets to relay"));
  CHECK(holds(told, "from nobody to relay"));
  CHECK(x.world.allow<serial_octets>().to(x.aut));
  CHECK(!failure_of([&] { x.world.disallow<radio_send>().to_anybody(); }).empty());
}

TEST_CASE("timers expire while time passes, and nothing is delivered", "[testkit][ACT-01]") {
  actor_fixture x;
  x.line.send(x.aut, octets(7));
  x.world.run();
  x.world.pass(999ms);
  x.world.expect_nothing();
  x.world.pass(1ms);
  x.world.expect<timer_expired>().to(x.aut);
  x.world.expect<radio_send>().to(x.air);
  x.line.send(x.aut, octets(8));
  x.world.run_for(5s); // with deliveries
  CHECK(x.air.count<radio_send>() == 4);
  CHECK(x.air.times<radio_send>().back() == instant(2s));
}

TEST_CASE("a message is dropped, late or there twice", "[testkit][ACT-01]") {
  const auto when = GENERATE(delivery::at_once, delivery::when_asked);
  actor_fixture x(when);
  x.world.run();
  x.world.drop<serial_octets>().from(x.line).to(x.aut);
  x.world.duplicate<radio_send>().to(x.air);
  x.world.delay<notable_event>(300ms).to(x.ecology);
  x.line.send(x.aut, octets(1)); // lost
  x.world.run();
  CHECK(x.air.size() == 0);
  x.line.send(x.aut, octets(2));
  x.world.run();
  CHECK(x.air.count<radio_send>() == 2);
  CHECK(x.air.all<radio_send>()[1].octets == payload(bytes{2}));
  CHECK(x.ecology.count<notable_event>() == 1); // that it begins
  x.world.run_for(2s);
  CHECK(x.air.count<radio_send>() == 3); // and the repetition, once
  REQUIRE(x.ecology.count<notable_event>() == 2);
  CHECK(x.ecology.times<notable_event>()[1] == instant(300ms));
}

TEST_CASE("what is on its way already can be dropped, late or there twice", "[testkit][ACT-01]") {
  actor_fixture x;
  x.world.run();
  x.line.send(x.aut, octets(1));
  x.line.send(x.aut, octets(2));
  x.world.duplicate<serial_octets>().to(x.aut);
  x.world.drop<serial_octets>()
      .where([](const serial_octets& y) { return y.octets == payload(bytes{2}); })
      .to(x.aut);
  x.world.expect<serial_octets>().to(x.aut);
  x.world.delay<serial_octets>(10ms).to(x.aut);
  x.world.disallow<serial_octets>().to(x.aut);
  x.world.pass(10ms);
  CHECK(x.world.expect<serial_octets>().to(x.aut).octets == payload(bytes{1}));
  x.world.disallow<serial_octets>().to(x.aut);
}

TEST_CASE("fakes answer as their scripts say", "[testkit][ACT-01]") {
  actor_fixture x(delivery::at_once);
  x.air.on<radio_send>([&x](const radio_send& sent) {
    if (sent.octets == payload(bytes{1}))
      x.line.send(x.aut, octets(2)); // of another fake's own
  });
  x.ecology.on<notable_event>([&x](const notable_event&) {
    x.ecology.on<notable_event>([](const notable_event&) {}); // once
    return octets(3);                                         // to the sender
  });
  x.line.send(x.aut, octets(1));
  REQUIRE(x.air.count<radio_send>() == 3);
  CHECK(x.air.all<radio_send>()[1].octets == payload(bytes{2}));
  CHECK(x.air.all<radio_send>()[2].octets == payload(bytes{3}));
}

TEST_CASE("a script that throws fails the test, not the fake", "[testkit][ACT-01]") {
  actor_fixture x(delivery::at_once);
  x.air.on<radio_send>([](const radio_send&) { throw std::runtime_error("not that"); });
  CHECK_THROWS_WITH(x.line.send(x.aut, octets(1)), "not that");
  CHECK(x.world.ends().empty());
  x.world.run_for(500ms);
  CHECK_THROWS_WITH(x.world.run_for(2s), "not that"); // the repetition
}

TEST_CASE("with messages delivered at once there is nothing to expect", "[testkit][ACT-01]") {
  actor_fixture x(delivery::at_once);
  CHECK_THROWS_AS(x.world.expect<notable_event>().to(x.ecology), std::logic_error);
  CHECK_THROWS_AS(x.world.disallow<notable_event>().to(x.ecology), std::logic_error);
  CHECK(x.ecology.count<notable_event>() == 1);
}
