#include "control/octets.hpp"

#include "support/catch.hpp"

using namespace rubicon;
using control::octets_of;
using control::part_report_of;

namespace {

report::part_report some_part() {
  report::part_report x;
  x.report.ecology = "house";
  x.report.simulated = 5s;
  x.report.islands.resize(2);
  x.report.islands[1].radio.lost["collision"] = 7;
  x.report.islands[1].motes.resize(1);
  x.report.islands[1].motes[0].signal_dbm = -50;
  x.report.expectations.push_back(
      {"joined", report::expectation_report::verdict::met, "3 motes", instant(1s)});
  auto& program = x.counters.programs[{"kitchen/fan", 1, "sampler"}];
  program.sum.figures = {{"readings", 12.5}};
  x.counters.streams[{"robot", 9}].writer.newest_ms = 1234;
  x.counters.accounts[{{island_id(1), mote_id(2)}, "message"}].came_over = 3;
  return x;
}

} // namespace

TEST_CASE("what a part tells is the same in another process", "[control]") {
  const auto before = some_part();
  const auto octets = octets_of(before);
  const auto after = part_report_of(octets);
  REQUIRE(after);
  CHECK(report::to_json(after->report) == report::to_json(before.report));
  CHECK(after->report.islands[1].motes[0].signal_dbm == -50);
  CHECK(after->counters.streams.at({"robot", 9}).writer.newest_ms == 1234U);
  CHECK(octets_of(*after) == octets);
}

TEST_CASE("half of what a part tells is nothing", "[control]") {
  const auto octets = octets_of(some_part());
  for (std::size_t size = 0; size < octets.size(); ++size)
    CHECK_FALSE(part_report_of(byte_view(octets).first(size)));
}
