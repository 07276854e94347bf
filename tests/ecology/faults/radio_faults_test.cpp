// What becomes of measured flows when motes fail.
#include <stdexcept>
#include <string>
#include <string_view>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

const report::flow_report& flow_of(const report::run_report& x, std::string_view from) {
  for (const auto& flow : x.flows) {
    if (flow.from_name == from)
      return flow;
  }
  throw std::runtime_error("no flow from " + std::string(from));
}

void check_counters(const report::run_report& x) {
  for (const auto& violation : x.violations)
    FAIL_CHECK(violation.invariant << ": " << violation.detail);
  for (const auto& flow : x.flows) {
    INFO(flow.from_name << " to " << flow.to_name);
    CHECK(flow.sent == flow.delivered + report::total(flow.lost) + flow.open);
  }
  const auto radio = x.radio();
  CHECK(radio.sent == radio.delivered + report::total(radio.lost));
  CHECK(radio.requests == radio.mac_sent + report::total(radio.mac_failed) + radio.mac_open);
}

/// A sender, a relay and the sink, beside a sender of its own.
constexpr const char* chain = R"(
  ecology = { name = "chain", duration = "30s" }
  [[island]]
  id = 1
  name = "hall"
  stack = "mac"
  sink.apps = [{ app = "receiver" }]
  mote = [
    { id = 2, name = "far", position_m = [40, 0], apps = [
      { app = "sender", to = "sink", via = "hall/middle", every = "50ms", start = "10ms" }] },
    { id = 3, name = "middle", position_m = [20, 0], apps = [{ app = "relay", next = "sink" }] },
    { id = 4, name = "near", position_m = [0, 5], apps = [
      { app = "sender", to = "sink", every = "70ms", start = "20ms" }] },
  ]
)";

report::run_report run_with(std::string_view faults) {
  return run(describe(std::string(chain).append(faults)));
}

} // namespace

TEST_CASE("a flow ends with its sender's battery", "[ecology][radio][NRG-05]") {
  const auto whole = run_with("");
  check_counters(whole);
  CHECK(whole.motes_alive() == 3);
  CHECK(flow_of(whole, "hall/far").sent == 600);
  CHECK(flow_of(whole, "hall/far").pdr > 0.98);

  const auto cut = run_with(R"(
    [[fault]]
    at = "10s"
    kind = "battery_end"
    mote = "hall/far"
  )");
  check_counters(cut);
  CHECK(cut.motes_alive() == 2);
  CHECK(flow_of(cut, "hall/far").sent == 200);
  CHECK(flow_of(cut, "hall/far").pdr > 0.98);
  CHECK(flow_of(cut, "hall/near").sent == flow_of(whole, "hall/near").sent);
  CHECK(flow_of(cut, "hall/near").pdr > 0.98);
}

TEST_CASE("a flow whose relay is dead is lost, with causes", "[ecology][radio]") {
  const auto report = run_with(R"(
    [[fault]]
    at = "10s"
    kind = "battery_end"
    mote = "hall/middle"
  )");
  check_counters(report);
  const auto& flow = flow_of(report, "hall/far");
  CHECK(flow.sent == 600);
  CHECK(flow.delivered == Approx(200).margin(4));
  CHECK(report::total(flow.lost) >= 395);
  CHECK(flow.lost.at("no_ack") >= 390); // nobody answers
  // Each is tried four times, so the price rises.
  CHECK(flow.tx_per_packet > 3);
  CHECK(flow_of(report, "hall/near").pdr > 0.98);
}

TEST_CASE("a flow goes on when its sender or its relay is restarted", "[ecology][radio][ACT-03]") {
  for (const auto* mote : {"hall/far", "hall/middle"}) {
    INFO(mote);
    const auto report = run_with("[[fault]]\nat = \"10s\"\nkind = \"crash\"\nmote = \"" +
                                 std::string(mote) + "\"\n");
    check_counters(report);
    CHECK(report.actors.restarted == 1);
    CHECK(report.actors.failures.empty());
    const auto& flow = flow_of(report, "hall/far");
    // Its second life numbers its packets anew; they are no repeats of the first life's.
    CHECK(flow.sent > 560);
    CHECK(flow.sent <= 600);
    CHECK(flow.delivered > 550);
    CHECK(flow_of(report, "hall/near").pdr > 0.98);
    CHECK(report.motes_alive() == 3);
  }
}

TEST_CASE("a saturated sender goes on after a restart", "[ecology][radio][ACT-03]") {
  const std::string toml = R"(
    ecology = { name = "busy", duration = "10s" }
    [[island]]
    id = 1
    name = "hall"
    stack = "mac"
    sink.apps = [{ app = "receiver" }]
    mote = [{ id = 2, name = "busy", position_m = [5, 0], apps = [
      { app = "sender", to = "sink", pattern = "saturated" }] }]
  )";
  const auto whole = run(describe(toml));
  const auto restarted = run(describe(toml + R"(
    [[fault]]
    at = "5s"
    kind = "crash"
    mote = "hall/busy"
  )"));
  check_counters(whole);
  check_counters(restarted);
  CHECK(restarted.actors.restarted == 1);
  const auto sent = static_cast<double>(flow_of(whole, "hall/busy").sent);
  CHECK(static_cast<double>(flow_of(restarted, "hall/busy").sent) == Approx(sent).epsilon(0.15));
  CHECK(flow_of(restarted, "hall/busy").pdr > 0.99);
}

TEST_CASE("a run may end while packets are in flight", "[ecology][radio]") {
  auto what = example("scenarios/line.toml");
  for (const auto length : {duration(11ms), duration(17ms), duration(101ms), duration(1'234ms)}) {
    what.length = length;
    const auto report = run(what);
    CHECK(report.simulated == length);
    check_counters(report);
    CHECK(flow_of(report, "saturated/sender").sent > 0);
    CHECK(flow_of(report, "saturated/sender").open > 0);
  }
}
