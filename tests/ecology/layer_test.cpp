// The Communication Layer's examples: streams over several hops, and a learning network.
#include "ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

double figure(const runtime::report& x, std::string_view who, std::string_view name) {
  for (const auto& program : x.programs) {
    if (program.who != who)
      continue;
    for (const auto& [each, value] : program.figures) {
      if (each == name)
        return value;
    }
  }
  FAIL("no such figure");
  return 0;
}

double duty_of(const runtime::mote_report& x) {
  return 1 - seconds(x.radio_off) / seconds(x.elapsed);
}

} // namespace

TEST_CASE("a stream over five hops arrives, while the radios of its relays sleep",
          "[ecology][NRG-02][NRG-03][STR-18]") {
  auto lines = example("stream-line.toml");
  lines.length = 20min;
  const auto report = run(lines);
  CHECK(report.violations.empty());
  CHECK(report.motes_joined() == 12);
  for (const auto* reader : {"sleepy/reader", "awake/reader"}) {
    CHECK(figure(report, reader, "records") > 1000);
    CHECK(figure(report, reader, "delivery %") >= 99);
  }
  for (const auto& island : report.islands) {
    for (const auto& mote : island.motes) {
      CAPTURE(island.name, mote.name);
      if (island.name == "awake")
        CHECK(duty_of(mote) == 1);
      else // all stay on for the first minute, a twentieth of the run
        CHECK(duty_of(mote) < 0.05 + 0.95 * 0.05);
    }
  }
}

TEST_CASE("a learning network over two islands and a PC says what comes next",
          "[ecology][SYN-06][SYN-10][SYN-16][PAR-01]") {
  auto network = example("learning.toml");
  network.length = 520s; // 1000 ticks and the time to set up
  const auto report = run(network);
  CHECK(report.violations.empty());
  CHECK(report.motes_joined() == 16);
  REQUIRE(report.programs.size() == 17);
  for (const auto& program : report.programs) {
    CAPTURE(program.who);
    CHECK(figure(report, program.who, "ticks") >= 1000);
    CHECK(figure(report, program.who, "vectors updated") >= 990);
    CHECK(figure(report, program.who, "vectors missed") == 0);
  }
  CHECK(figure(report, "learner", "prediction error") <
        0.6 * figure(report, "learner", "error of the last value"));
}
