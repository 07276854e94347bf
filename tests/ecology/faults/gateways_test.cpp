// An island with two gateways: crashes, pulled cables, and what its users notice of them (GW-14).
#include <algorithm>
#include <string>
#include <vector>

#include "ecology/ecology_files.hpp"
#include "explain/traces.hpp"
#include "recorded.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

constexpr peer_id first{20};
constexpr peer_id second{21};
constexpr island_id kitchen{20};
constexpr duration patience = 5s; ///< of users, with a gateway that has ended

/// The scenario with other faults.
config::ecology_description kitchen_with(std::vector<config::fault_description> faults,
                                         duration length = 3min) {
  auto x = example("scenarios/two-gateways.toml");
  x.length = length;
  x.faults = std::move(faults);
  return x;
}

config::fault_description killed(duration at, peer_id who, duration length) {
  return {at, config::kill_fault{who, length}};
}

config::fault_description unplugged(duration at, peer_id whose, duration length) {
  return {at, config::unplug_fault{kitchen, length, whose}};
}

/// Of moments from 30 s on, when all have joined, to the end.
duration longest_gap(const std::vector<instant>& all, duration length) {
  duration longest{};
  instant last{30s};
  for (const auto t : all) {
    if (t < last)
      continue;
    longest = std::max<duration>(longest, t - last);
    last = t;
  }
  return std::max<duration>(longest, instant(length) - last);
}

const report::island_report& kitchen_of(const report::run_report& x) {
  return *std::ranges::find(x.islands, kitchen, &report::island_report::id);
}

std::uint64_t times_led(const report::run_report& x, peer_id who) {
  const auto& all = kitchen_of(x).gateways;
  return std::ranges::find(all, who, &report::gateway_report::id)->lead.led;
}

void check_motes_stayed(const report::run_report& x) {
  CHECK(told_violations(x).empty());
  CHECK(x.motes_joined() == x.motes_configured());
  CHECK(!has_logged(x, "", "left"));
  CHECK(!has_logged(x, "", "joined again"));
}

/// Each request has had one outcome, and the fan has done no more than it was asked.
void check_actuations(const recorded& x) {
  const auto& fan = proxy_of(x.report, "kitchen.fan").actuations;
  std::uint64_t failed = 0;
  for (const auto& [cause, count] : fan.failed)
    failed += count;
  CHECK(fan.acknowledged > 0);
  CHECK(fan.acknowledged + failed <= fan.requested);
  CHECK(fan.acknowledged + failed + 1 >= fan.requested); // one may be in flight at the end
  const auto done = x.times(explain::kind::actuator_changed, "").size();
  CHECK(done <= fan.requested);
  CHECK(done >= fan.acknowledged);
}

/// What the robot, on another computer, has heard of the climate: no reading twice.
void check_readings(const recorded& x, duration length, duration gap_max) {
  const auto heard = x.times(explain::kind::tuple_event, "peer_app/robot/collector",
                             "kitchen.climate-2.temperature");
  const auto sent = x.times(explain::kind::send_message, "mote/kitchen/climate-2");
  CHECK(heard.size() <= sent.size());
  CHECK(longest_gap(heard, length) <= gap_max);
}

} // namespace

TEST_CASE("readings and commands go on when the gateway that leads crashes",
          "[ecology][GW-14][PXY-14][IF-07]") {
  const auto what = kitchen_with({killed(1min, first, 40s)});
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    const auto x = run_recorded(what, seed);
    check_motes_stayed(x.report);
    check_readings(x, what.length, patience);
    check_actuations(x);
    CHECK(times_led(x.report, first) == 2); // at the start, and when it is back
    CHECK(times_led(x.report, second) == 1);
    CHECK(has_logged(x.report, "attic-pc", "leads"));
    CHECK(proxy_of(x.report, "kitchen.climate-2").status == "active");
  }
}

TEST_CASE("readings and commands go on when the cable of the gateway that leads is pulled",
          "[ecology][GW-14][GW-15][IF-07]") {
  const auto what = kitchen_with({unplugged(1min, first, 40s)});
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    const auto x = run_recorded(what, seed);
    check_motes_stayed(x.report);
    check_readings(x, what.length, patience);
    check_actuations(x);
    CHECK(times_led(x.report, second) == 1);
  }
}

TEST_CASE("nobody notices that the gateway that stands by has ended, or lost its cable",
          "[ecology][GW-14]") {
  const auto what = kitchen_with({killed(1min, second, 20s), unplugged(2min, second, 20s)});
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    const auto x = run_recorded(what, seed);
    check_motes_stayed(x.report);
    check_readings(x, what.length, 3s);
    check_actuations(x);
    CHECK(times_led(x.report, first) == 1);
    CHECK(times_led(x.report, second) == 0);
  }
}

TEST_CASE("an island without any gateway is whole again when one is back", "[ecology][GW-14]") {
  const auto what = kitchen_with(
      {unplugged(1min, first, 40s), killed(70s, second, 1min), killed(110s, first, 1min)}, 5min);
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    const auto x = run_recorded(what, seed);
    check_motes_stayed(x.report);
    check_readings(x, what.length, 60s);
    check_actuations(x);
    CHECK(proxy_of(x.report, "kitchen.fan").status == "active");
  }
}

TEST_CASE(
    "whatever happens to two gateways and their cables, each actuation has one outcome and the "
    "island is whole at last",
    "[ecology][GW-14][GW-15][IF-07]") {
  const auto at_random = [](config::fault what) {
    return config::fault_description{0s, std::move(what),
                                     config::fault_times{{}, 5, 0s, std::optional<duration>(9min)}};
  };
  const auto what = kitchen_with({at_random(config::kill_fault{first, 20s}),
                                  at_random(config::kill_fault{second, 15s}),
                                  at_random(config::unplug_fault{kitchen, 12s, first}),
                                  at_random(config::unplug_fault{config::any_island, 3s})},
                                 12min);
  for (std::uint64_t seed = 1; seed <= seeds(4); ++seed) {
    CAPTURE(seed);
    const auto x = run_recorded(what, seed);
    CHECK(told_violations(x.report).empty());
    check_actuations(x);
    const auto heard = x.times(explain::kind::tuple_event, "peer_app/robot/collector",
                               "kitchen.climate-2.temperature");
    CHECK(heard.size() <= x.times(explain::kind::send_message, "mote/kitchen/climate-2").size());
    CHECK(heard.back() > instant(what.length - patience));
  }
}

TEST_CASE("messages from another island reach either id once, through whichever gateway leads",
          "[ecology][GW-14][ACK-09]") {
  for (const auto called : {20U, 21U}) {
    CAPTURE(called);
    auto what = kitchen_with({killed(1min, first, 40s)});
    auto& button =
        std::get<config::messenger_app>(what.islands.at(1).motes.at(0).apps.edit().at(0));
    REQUIRE(what.islands.at(1).name == "hall");
    button.to.island = island_id{called};
    for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
      CAPTURE(seed);
      const auto x = run_recorded(what, seed);
      const auto sent = x.times(explain::kind::send_message, "mote/hall/button").size();
      std::size_t heard = 0;
      std::size_t heard_in_between = 0;
      for (const auto& each : x.content.records) {
        if (each.what != explain::kind::message_received || each.from != "mote/kitchen/pager")
          continue;
        ++heard;
        CHECK(each.mote == mote_address{island_id{30}, mote_id{2}});
        heard_in_between += each.time > instant{65s} && each.time < instant{100s} ? 1 : 0;
      }
      CHECK(heard <= sent);
      CHECK(heard + 2 >= sent);
      CHECK(heard_in_between >= 3);
      const auto& hall = x.report.islands.at(1).messages;
      CHECK(hall.reliable_acked + 2 >= sent);
    }
  }
}

TEST_CASE("what is subscribed to is sent on by motes when another gateway leads",
          "[ecology][GW-14][GW-10]") {
  auto what = kitchen_with({killed(1min, first, 40s)});
  for (auto& mote : what.islands.at(0).motes)
    for (auto& app : mote.apps.edit())
      if (auto* sampler = std::get_if<config::sampler_app>(&app))
        sampler->only_subscribed = true;
  what.peers.at(0).apps.clear(); // no proxies: the robot looks at the gateways
  std::get<config::collector_app>(what.peers.at(1).apps.at(0)).keys = {"devices.*.output.1"};
  const auto x = run_recorded(what);
  CHECK(told_violations(x.report).empty());
  const auto heard =
      x.times(explain::kind::tuple_event, "peer_app/robot/collector", "devices.2.output.1");
  CHECK(longest_gap(heard, what.length) <= patience);
}

TEST_CASE("the period that a proxy asks for outlives the gateway that was told it first",
          "[ecology][GW-14][PXY-14][IF-04]") {
  auto what = kitchen_with({killed(1min, first, 10min)});
  for (auto& mote : what.islands.at(0).motes)
    for (auto& app : mote.apps.edit())
      if (auto* sampler = std::get_if<config::sampler_app>(&app)) {
        sampler->only_subscribed = true;
        sampler->every = 10s;
        sampler->every_min = 1s;
      }
  for (auto& proxied : what.proxies)
    proxied.settings.period = 1s;
  const auto values = run_recorded(what).at("kitchen.climate-2.temperature");
  const auto late = std::ranges::count_if(
      values, [](const set_value& x) { return x.time > instant(1min + patience); });
  CHECK(late > 100); // of 115
}

TEST_CASE("what is told of a message names the gateway that it took", "[ecology][GW-14][NFR-01]") {
  const auto x = run_recorded(kitchen_with({killed(1min, first, 40s)}));
  const auto all = explain::follow(x.content);
  std::size_t through_second = 0;
  for (const auto& each : all.messages)
    CHECK(each.destination.island != island_id{21}); // the island's id, whoever speaks for it
  for (const auto& each : all.nodes)
    through_second += each.to == "gateway/kitchen/attic-pc" && each.arrived.has_value() ? 1 : 0;
  CHECK(through_second > 30);
  const auto told = std::ranges::find_if(x.report.event_log, [](const auto& line) {
    return line.who == "attic-pc" && line.what == "leads island 20, term 2";
  });
  CHECK(told != x.report.event_log.end());
}

TEST_CASE("motes keep the time of peers when another gateway tells it",
          "[ecology][GW-14][CLK-08]") {
  const auto x = run(kitchen_with({killed(1min, first, 10min)}, 5min));
  const auto& network = kitchen_of(x).network;
  CHECK(network.aligned > 0);
  CHECK(network.time_error_max < 5ms);
  CHECK(kitchen_of(x).gateways.at(1).lead.leads);
  CHECK(kitchen_of(x).gateways.at(1).lead.leading > 230s);
}

TEST_CASE("the scenario of two gateways runs as its file says", "[ecology][GW-14]") {
  const auto what = example("scenarios/two-gateways.toml");
  const auto x = run(what);
  CHECK(told_violations(x).empty());
  CHECK(!has_logged(x, "", "left"));
  CHECK(proxy_of(x, "kitchen.fan").status == "active");
  CHECK(report::to_text(x).find("led by kitchen-pc: ") != std::string::npos);
  CHECK(run(what).trace_hash == x.trace_hash);
}
