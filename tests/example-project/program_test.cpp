// The frost guard in an actor of its own, alone with a fake of its mote.
#include <catch2/catch.hpp>

#include <actors/island/program.hpp>
#include <testkit/fake.hpp>
#include <testkit/fixture.hpp>

#include "frost_guard.hpp"

using namespace rubicon;
using namespace std::chrono_literals;
namespace remote = rubicon::communication::remote;

/// The command of that kind in a batch; nullptr: there is none.
template <class Command>
static const Command* find(const program_commands& x) {
  for (const auto& each : x.batch.all)
    if (const auto* found = std::get_if<Command>(&each))
      return found;
  return nullptr;
}

template <class Command>
static bool holds(const program_commands& x) {
  return find<Command>(x) != nullptr;
}

/// A guard that looks every 10 s and warns below 3.5 degrees, and what is around it.
struct guard_alone {
  test::fixture world{test::delivery::when_asked};
  test::fake<mote_actor> mote{world, "mote"};
  test::fake<ecology_actor> ecology{world, "ecology"};
  program_actor guard;
  std::int16_t counts = 80; ///< of 0.1 degrees
  std::uint64_t taken = 0;

  guard_alone() {
    program_arguments x;
    x.mote = "bed/south";
    apps::custom_config config;
    config.kind = std::make_shared<const apps::application_kind>(frost_guard_kind());
    config.values.set("below", 3.5);
    config.values.set("every", duration(10s));
    x.config = config;
    x.ecology = ecology.handle();
    guard =
        world.spawn_at("guard", program_behavior, std::make_shared<const program_arguments>(x), 0U);
    mote.on<attach_program>([](const attach_program&) {
      return program_attached{{.transducer_mask = ~0U, .sends_max = 4, .payload_max = 256}, 0};
    });
    mote.on<program_commands>([this](const program_commands& x) { answer(x); });
    mote.send(guard, mote_started{mote});
    world.expect<mote_started>().from(mote).to(guard);
    world.expect<attach_program>().from(guard).to(mote);
    world.expect<program_attached>().from(mote).to(guard);
    mote.send(guard, program_events{{0, {remote::joined{{island_id{1}, mote_id{2}}, true}}}});
    world.run();
  }

  /// The fake's thermometer.
  void answer(const program_commands& x) {
    taken += x.batch.all.size();
    if (holds<remote::read_transducers>(x))
      mote.send(guard, program_events{{taken, {remote::transducers_read{{counts}}}}});
  }

  /// The guard looks at the thermometer.
  void look() {
    world.pass(10s);
    world.expect<timer_expired>().to(guard);
    world.expect<program_commands>().where(holds<remote::read_transducers>).from(guard).to(mote);
    world.expect<program_events>().from(mote).to(guard);
  }
};

TEST_CASE("the guard asks for the temperature, and is silent while it is warm") {
  guard_alone x;
  x.look();
  x.world.disallow<notable_event>().to_anybody();
  x.world.disallow<program_commands>().where(holds<remote::send_message>).to(x.mote);
}

TEST_CASE("the guard sends one warning when it becomes cold") {
  guard_alone x;
  x.counts = 34;
  x.look();
  CHECK(x.world.expect<notable_event>().from(x.guard).to(x.ecology).what == "frost!");
  const auto sent = x.world.expect<program_commands>().from(x.guard).to(x.mote);
  REQUIRE(holds<remote::send_message>(sent));
  CHECK(find<remote::send_message>(sent)->octets == payload(bytes{1}));
  CHECK(find<remote::send_message>(sent)->reliable);
  x.look();
  x.world.disallow<notable_event>().to_anybody(); // it has said so
}

TEST_CASE("an answer that is lost does not keep the guard from looking again") {
  guard_alone x;
  x.world.drop<program_events>().from(x.mote).to(x.guard);
  x.world.run_for(10s);
  x.counts = 20;
  x.look();
  CHECK(x.world.expect<notable_event>().to(x.ecology).what == "frost!");
}
