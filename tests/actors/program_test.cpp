// A program in an actor of its own, without its mote.
#include "actors/island/program.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/supervision.hpp"

#include <caf/binary_deserializer.hpp>
#include <caf/binary_serializer.hpp>

#include "actors/kitchen.hpp"
#include "communication/program_port.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::stove;

namespace {

namespace r = communication::remote;

struct program_fixture {
  program_fixture() {
    program_arguments x;
    x.mote = "kitchen/stove";
    x.number = 3;
    x.config =
        apps::stream_writer_config{device::quantity::temperature, 1s, {island_id{5}, no_mote}, 7};
    x.seed = 4;
    x.ecology = ecology.handle();
    program = world.spawn_at("program/kitchen/stove/stream_writer-3", program_behavior,
                             std::make_shared<const program_arguments>(std::move(x)), 0U);
  }

  void attach(std::uint32_t incarnation = 0) {
    r::limits limits;
    limits.transducer_mask = 1U << static_cast<unsigned>(device::quantity::temperature);
    limits.streams_max = 5;
    limits.record_max = 105;
    world.send(program, program_attached{limits, incarnation});
  }

  void tell(r::events events, std::uint64_t taken = 0) {
    world.send(program, program_events{{taken, std::move(events)}});
  }

  fixture world;
  fake<mote_actor> mote{world};
  fake<ecology_actor> ecology{world};
  program_actor program;
};

} // namespace

TEST_CASE("a program attaches itself to its mote, and gives it commands as it hears of events",
          "[actors][program][PAR-05][AM-02][ACT-01]") {
  program_fixture x;
  CHECK(x.mote.size() == 0);
  x.world.send(x.program, mote_started{x.mote});
  REQUIRE(x.mote.count<attach_program>() == 1);
  CHECK(x.mote.all<attach_program>()[0].number == 3);
  x.attach();
  x.tell({r::initialised{true}, r::joined{stove, true}});
  REQUIRE(x.mote.count<program_commands>() == 1);
  const auto sent = x.mote.all<program_commands>()[0];
  CHECK(sent.number == 3);
  CHECK(sent.batch.taken == 2);
  REQUIRE(sent.batch.all.size() == 1);
  const auto open = std::get<r::open_end>(sent.batch.all[0]);
  CHECK(open.end.name == 7);
  CHECK(open.end.other == mote_address{island_id{5}, no_mote});

  x.tell({r::stream_opened{open.stream, 7, false}}, 1);
  CHECK(x.mote.all<program_commands>().back().batch.all.empty()); // only that it has come
  x.mote.forget();
  x.world.run_for(10s);
  REQUIRE(x.mote.count<program_commands>() == 1); // after a pause, again
  CHECK(std::holds_alternative<r::open_end>(x.mote.all<program_commands>()[0].batch.all.at(0)));
  x.world.send(x.program, status_request{});
  REQUIRE(x.ecology.count<program_status>() == 1);
  const auto status = x.ecology.all<program_status>()[0].program;
  CHECK(status.who == "kitchen/stove");
  CHECK(status.kind == "stream_writer");
  CHECK(status.figures.back() == std::pair<std::string, double>("opens failed", 1));
}

TEST_CASE("a program is silent without its mote, and begins again with the mote's next life",
          "[actors][program][PAR-05][ACT-03]") {
  const bool flat = GENERATE(true, false);
  program_fixture x;
  x.world.send(x.program, mote_started{x.mote});
  x.attach();
  x.tell({r::joined{stove, true}});
  x.tell({r::stream_opened{1, 7, false}}, 1); // it will try again
  x.mote.forget();
  if (flat)
    x.world.send(x.program, program_detached{});
  else
    post_exit(x.mote.handle(), caf::exit_reason::kill);
  x.world.run_for(1min);
  x.tell({r::joined{stove, true}}); // of nobody that it knows
  CHECK(x.mote.size() == 0);
  x.world.send(x.program, status_request{});
  CHECK(x.ecology.count<program_status>() == 1); // what it has counted does not go with it
  if (flat)
    return;
  fake<mote_actor> next(x.world);
  x.world.send(x.program, mote_started{next});
  CHECK(next.count<attach_program>() == 1);
  x.attach(1);
  x.tell({r::joined{stove, true}});
  REQUIRE(next.count<program_commands>() == 1);
  CHECK(std::get<r::open_end>(next.all<program_commands>()[0].batch.all.at(0)).stream == 1);
}
