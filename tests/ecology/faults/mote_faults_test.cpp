// What the fault plan does to motes, sinks and their radios: each kind, with several seeds
// (ACT-04).
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "ecology/ecology_files.hpp"
#include "ecology/island/lamp_and_climate.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// Three, or as many as whoever works on this asks for.
std::uint64_t usual_seeds() {
  const auto* wanted = std::getenv("RUBICON_SEEDS");
  return wanted == nullptr ? 3 : std::stoul(wanted);
}

/// Two islands apart, each with a lamp and two thermometers, of which one is a hop behind the
/// other; a PC with their proxies that switches the flat's lamp now and then.
const std::string two_islands = std::string(R"(
  ecology = { name = "plan", duration = "20min" }
  [radio]
  range = "15m"
  [mote_type.climate]
  type = 100
  transducers.temperature = { model = "sine", mean = 21, amplitude = 3, period = "2min", resolution = 0.1 }
  apps = [{ app = "sampler", transducers = ["temperature"], every = "5s" }]
  [mote_type.lamp]
  type = 200
  actuators = [{ name = "switch", kind = "relay" }]
  apps = [{ app = "actuator", actuator = "switch" }]
  [[island]]
  id = 1
  name = "flat"
  mote = [
    { id = 2, name = "lamp", type = "lamp", position_m = [5, 0] },
    { id = 3, name = "near", type = "climate", position_m = [10, 0] },
    { id = 4, name = "far", type = "climate", position_m = [20, 0] },
  ]
  [[island]]
  id = 2
  name = "shed"
  sink.position_m = [200, 0]
  mote = [
    { id = 2, name = "lamp", type = "lamp", position_m = [205, 0] },
    { id = 3, name = "near", type = "climate", position_m = [210, 0] },
    { id = 5, name = "end", type = "climate", position_m = [220, 0] },
  ]
  [[peer]]
  id = 40
  name = "pc"
  apps = [{ app = "proxy_manager" }, { app = "rules", rules = [
    { when = "flat.near.temperature", above = 21.5, below = 20.5, write = "flat.lamp.switch", then = "on", otherwise = "off" }] }]
)")
                                    .append(lamp_and_climate);

/// Runs it with many seeds and these faults; checks what always holds, and `more` of each report.
template <class More>
void run_all(const std::string& faults, More more) {
  const auto what = describe(two_islands + faults);
  for (std::uint64_t seed = 1; seed <= seeds(usual_seeds()); ++seed) {
    CAPTURE(seed);
    const auto report = run(what, seed);
    INFO(told_violations(report));
    CHECK(report.violations.empty());
    more(report);
  }
}

const report::mote_report& mote_of(const report::run_report& x, std::string_view island,
                                   std::string_view name) {
  for (const auto& each : x.islands)
    for (const auto& mote : each.motes)
      if (each.name == island && mote.name == name)
        return mote;
  throw std::runtime_error("there is no mote " + std::string(island) + '/' + std::string(name));
}

/// When somebody is told to have done that; nothing: never.
std::optional<instant> when(const report::run_report& x, std::string_view who,
                            std::string_view what, instant from = {}) {
  for (const auto& line : x.event_log)
    if (line.at >= from && line.who == who && line.what.starts_with(what))
      return line.at;
  return std::nullopt;
}

std::size_t how_often(const report::run_report& x, std::string_view who, std::string_view what) {
  return static_cast<std::size_t>(std::ranges::count_if(x.event_log, [&](const auto& line) {
    return line.who == who && line.what.starts_with(what);
  }));
}

} // namespace

TEST_CASE("a mote that is off for long leaves, and joins as a later life",
          "[ecology][ACT-04][DIS-07]") {
  run_all(R"(
    [[fault]]
    at = "5min"
    kind = "crash"
    mote = "flat/near"
    for = "6min"
  )",
          [](const report::run_report& x) {
            CHECK(when(x, "flat/near", "crashed as planned, out for 6 min") == instant(5min));
            const auto left = when(x, "flat/near", "left: silence");
            REQUIRE(left);
            CHECK(*left < instant(6min));
            const auto again = when(x, "flat/near", "joined again, life 2");
            REQUIRE(again);
            CHECK(*again >= instant(11min));
            CHECK(*again < instant(12min));
            CHECK(mote_of(x, "flat", "near").incarnations == 2);
            CHECK(mote_of(x, "flat", "far").incarnations == 1);
            CHECK(x.motes_alive() == 6);
            CHECK(proxy_of(x, "flat.near").status == "active");
          });
}

TEST_CASE("a mote that is off at the end is expected nowhere", "[ecology][ACT-04]") {
  run_all(R"(
    [[fault]]
    at = "10min"
    kind = "crash"
    mote = "flat/far"
    for = "1h"
  )",
          [](const report::run_report& x) {
            CHECK(x.motes_alive() == 5);
            CHECK_FALSE(mote_of(x, "flat", "far").alive);
            CHECK(mote_of(x, "flat", "far").incarnations == 1);
          });
}

TEST_CASE("every life of a mote is later than those before, whatever cuts it short",
          "[ecology][ACT-04][DIS-07]") {
  run_all(R"(
    [[fault]]
    every = "20s"
    from = "1min"
    until = "9min"
    kind = "crash"
    mote = "flat/near"
  )",
          [](const report::run_report& x) {
            CHECK(mote_of(x, "flat", "near").incarnations == 26);
            CHECK(has_logged(x, "flat/near", "joined again, life 26"));
            std::uint32_t last = 0; // lives that its gateway is told of only ever grow
            for (const auto& line : x.event_log) {
              constexpr std::string_view words = "joined again, life ";
              if (line.who != "flat/near" || !line.what.starts_with(words))
                continue;
              const auto life =
                  static_cast<std::uint32_t>(std::stoul(line.what.substr(words.size())));
              CHECK(life > last);
              last = life;
            }
          });
}

TEST_CASE("a sink that is off takes its island with it, and as a later life has it again",
          "[ecology][ACT-04][GW-15]") {
  run_all(R"(
    [[fault]]
    at = "4min"
    kind = "crash"
    sink = "flat"
    for = "3min"
  )",
          [](const report::run_report& x) {
            CHECK(when(x, "flat/sink", "crashed as planned, out for 3 min") == instant(4min));
            CHECK(when(x, "flat/sink", "started again, life 2") == instant(7min));
            for (const auto* name : {"flat.lamp", "flat.near", "flat.far"}) {
              CAPTURE(name);
              CHECK(proxy_of(x, name).status == "active");
            }
            for (const auto& island : x.islands)
              for (const auto& mote : island.motes)
                CHECK(mote.incarnations == 1); // only the sink was off
            CHECK_FALSE(when(x, "shed/near", "left"));
          });
}

TEST_CASE("a sink that reboots at once has its island back in a minute", "[ecology][ACT-04]") {
  run_all(R"(
    [[fault]]
    every = "2min"
    from = "4min"
    until = "12min"
    kind = "crash"
    sink = "*"
  )",
          [](const report::run_report& x) {
            CHECK(how_often(x, "flat/sink", "started again") +
                      how_often(x, "shed/sink", "started again") ==
                  5);
            CHECK(x.motes_alive() == 6);
            CHECK(proxy_of(x, "flat.far").status == "active");
            CHECK(proxy_of(x, "shed.end").status == "active");
          });
}

TEST_CASE("a mote whose clock was set goes on, and knows the island's time again",
          "[ecology][ACT-04][CLK-01]") {
  const auto by = GENERATE("5s", "-5s", "90ms", "-90ms", "10min", "-1min");
  CAPTURE(by);
  run_all(std::string(R"(
    [[fault]]
    at = "3min"
    kind = "clock_step"
    mote = "flat/near"
    by = ")") +
              by + "\"\n",
          [](const report::run_report& x) {
            CHECK(when(x, "flat/near", "clock set ") == instant(3min));
            CHECK(mote_of(x, "flat", "near").incarnations == 1);
            CHECK(proxy_of(x, "flat.near").status == "active");
            CHECK(proxy_of(x, "flat.far").status == "active");
            CHECK(x.islands.at(0).network.clock_error_max < 3ms);
          });
}

TEST_CASE("a sink whose clock was set takes the time of its island with it",
          "[ecology][ACT-04][CLK-01]") {
  const auto by = GENERATE("5s", "-5s", "10min");
  CAPTURE(by);
  run_all(std::string(R"(
    [[fault]]
    at = "3min"
    kind = "clock_step"
    sink = "flat"
    by = ")") +
              by + "\"\n",
          [](const report::run_report& x) {
            CHECK(when(x, "flat/sink", "clock set ") == instant(3min));
            CHECK(proxy_of(x, "flat.far").status == "active");
            CHECK(x.islands.at(0).network.clock_error_max < 3ms);
            CHECK(x.islands.at(0).network.time_error_max < 10ms);
          });
}

TEST_CASE("noise silences who is near, and nobody else", "[ecology][ACT-04]") {
  run_all(R"(
    [[fault]]
    at = "5min"
    kind = "noise"
    island = "flat"
    position_m = [34, 0]
    for = "4min"
  )",
          [](const report::run_report& x) {
            CHECK(when(x, "plan", "noise at 34, 0 for 4 min") == instant(5min));
            const auto left = when(x, "flat/far", "left");
            REQUIRE(left);
            CHECK(*left < instant(6min));
            const auto again = when(x, "flat/far", "joined again, life 1");
            REQUIRE(again);
            CHECK(*again >= instant(9min));
            CHECK_FALSE(when(x, "flat/near", "left")); // 24 m away
            CHECK_FALSE(when(x, "shed/end", "left"));
          });
}

TEST_CASE("noise in bursts costs frames in proportion", "[ecology][ACT-04]") {
  const auto noisy = [](const char* duty) {
    const auto what = describe(two_islands + R"(
      [[fault]]
      at = "1min"
      kind = "noise"
      island = "flat"
      position_m = [12, 0]
      burst = "3ms"
      for = "19min"
      duty = )" + duty + "\n");
    const auto report = run(what);
    CHECK(report.violations.empty());
    const auto& radio = report.islands.at(0).radio;
    const auto found = radio.lost.find("collision");
    return static_cast<double>(found == radio.lost.end() ? 0 : found->second) /
           static_cast<double>(radio.sent);
  };
  const auto hardly = noisy("0.0001");
  const auto little = noisy("0.02");
  const auto much = noisy("0.2");
  CHECK(little > 2 * hardly);
  CHECK(much > 2 * little);
}

TEST_CASE("a radio that loses all is silent, one that loses some repeats", "[ecology][ACT-04]") {
  run_all(R"(
    [[fault]]
    at = "5min"
    kind = "radio_loss"
    loss = 1
    island = "flat"
    for = "2min"
    [[fault]]
    at = "10min"
    kind = "radio_loss"
    loss = "30%"
    for = "2min"
  )",
          [](const report::run_report& x) {
            CHECK(when(x, "flat", "radio loses frames for 2 min") == instant(5min));
            CHECK(when(x, "plan", "radio loses frames for 2 min") == instant(10min));
            for (const auto* name : {"flat/lamp", "flat/near", "flat/far"}) {
              CAPTURE(name);
              const auto left = when(x, name, "left");
              REQUIRE(left);
              CHECK(*left > instant(5min));
              CHECK(*left < instant(7min));
              CHECK(when(x, name, "joined again, life 1", instant(7min)));
            }
            CHECK_FALSE(when(x, "shed/near", "left"));
            CHECK(x.islands.at(1).radio.lost.at("loss") > 0); // of the second fault
          });
}

TEST_CASE("a second mote with an id is refused and said, and the first is not touched",
          "[ecology][ACT-04][ADR-04]") {
  run_all(R"(
    [[fault]]
    at = "4min"
    kind = "duplicate_id"
    mote = "flat/near"
    position_m = [8, 3]
    for = "10min"
  )",
          [](const report::run_report& x) {
            CHECK(when(x, "flat/near-double", "appears, with the id of flat/near") ==
                  instant(4min));
            CHECK(how_often(x, "flat/sink", "refused a second mote with the id 3") == 1);
            CHECK(how_often(x, "flat/near-double", "is silent: another mote has its id") >= 2);
            CHECK(when(x, "flat/near-double", "gone") == instant(14min));
            CHECK(x.islands.at(0).network.lost.at("id_taken") >= 2);
            CHECK(x.islands.at(1).network.lost.at("id_taken") == 0);
            CHECK(how_often(x, "flat/near", "left") == 0);
            CHECK(how_often(x, "flat/near", "joined again") == 0);
            CHECK(mote_of(x, "flat", "near").incarnations == 1);
            CHECK(proxy_of(x, "flat.near").status == "active");
          });
}

TEST_CASE("a mote that reboots while there is a second one is itself at once",
          "[ecology][ACT-04][ADR-04][DIS-07]") {
  run_all(R"(
    [[fault]]
    at = "4min"
    kind = "duplicate_id"
    mote = "flat/near"
    position_m = [8, 3]
    for = "10min"
    [[fault]]
    at = "6min"
    kind = "crash"
    mote = "flat/near"
  )",
          [](const report::run_report& x) {
            const auto again = when(x, "flat/near", "joined again, life 2");
            REQUIRE(again);
            CHECK(*again < instant(6min + 10s));
            CHECK(how_often(x, "flat/near", "joined again") == 1);
            CHECK(how_often(x, "flat/near", "left") == 0);
            CHECK(proxy_of(x, "flat.near").status == "active");
          });
}

TEST_CASE("a second mote takes the place of one that is gone, until that one is back",
          "[ecology][ACT-04][ADR-04]") {
  run_all(R"(
    [[fault]]
    at = "4min"
    kind = "crash"
    mote = "flat/near"
    for = "8min"
    [[fault]]
    at = "5min"
    kind = "duplicate_id"
    mote = "flat/near"
    position_m = [8, 3]
    for = "10min"
  )",
          [](const report::run_report& x) {
            const auto replaced = when(x, "flat/near", "joined again, life 1");
            REQUIRE(replaced); // a new board with the old id
            CHECK(*replaced < instant(6min));
            CHECK(when(x, "flat/near", "is silent: another mote has its id")); // the old one
            const auto own = when(x, "flat/near", "joined again, life 2", instant(15min));
            CHECK(own);
            CHECK(proxy_of(x, "flat.near").status == "active");
          });
}

TEST_CASE("a mote that is carried to another island leaves its own and joins that one",
          "[ecology][ACT-04]") {
  run_all(R"(
    [[fault]]
    at = "4min"
    kind = "move"
    mote = "flat/far"
    to_island = "shed"
    to_m = [206, 5]
    for = "20s"
  )",
          [](const report::run_report& x) {
            CHECK(when(x, "flat/far", "carried away, to be shed/far in 20 s") == instant(4min));
            CHECK(x.islands.at(0).motes.size() == 2);
            CHECK(x.islands.at(1).motes.size() == 4);
            std::size_t there = 0;
            for (const auto& mote : x.islands.at(1).motes) {
              if (mote.address.mote != mote_id{4})
                continue;
              ++there;
              CHECK(mote.incarnations == 2);
              CHECK(mote.alive);
              CHECK(mote.left_cause.empty());
              CHECK(mote.energy.used_mah > 0);
              CHECK(mote.energy.elapsed == 15min + 40s);
            }
            CHECK(there == 1);
            CHECK(x.motes_alive() == 6);
          });
}

TEST_CASE("a mote that is of another type when it starts again has another proxy",
          "[ecology][ACT-04][PXY-09]") {
  run_all(R"(
    [[fault]]
    at = "4min"
    kind = "crash"
    mote = "flat/far"
    type = "lamp"
  )",
          [](const report::run_report& x) {
            CHECK(when(x, "flat/far", "joined again, life 2"));
            CHECK(mote_of(x, "flat", "far").type == "lamp");
            CHECK(proxy_of(x, "flat.far").proxy_class == "lamp");
            CHECK(proxy_of(x, "flat.far").status == "active");
          });
}

TEST_CASE("faults go on hitting a mote that was carried away, by the name that it had",
          "[ecology][ACT-04]") {
  run_all(R"(
    [[fault]]
    at = "270s"
    kind = "move"
    mote = "flat/far"
    to_island = "shed"
    to_m = [206, 5]
    [[fault]]
    every = "1min"
    from = "2min"
    until = "8min"
    kind = "crash"
    mote = "flat/far"
    type = "climate"
    [[fault]]
    at = "9min"
    kind = "clock_step"
    mote = "flat/far"
    by = "1s"
    [[fault]]
    at = "10min"
    kind = "move"
    mote = "flat/far"
    to_island = "shed"
    to_m = [206, 5]
    [[fault]]
    at = "10min"
    kind = "noise"
    island = "shed"
    position_m = [200, 90]
    power = "30dBm"
    [[fault]]
    at = "10min"
    kind = "noise"
    island = "shed"
    position_m = [200, 1]
    power = "-100dBm"
    duty = "1%"
    for = "1s"
  )",
          [](const report::run_report& x) {
            CHECK(when(x, "shed/far", "clock set forward by 1 s") == instant(9min));
            CHECK(how_often(x, "flat/far", "carried away") == 1);
            CHECK(how_often(x, "shed/far", "crashed") == 4);
            CHECK(mote_of(x, "shed", "far").incarnations == 9);
            CHECK(mote_of(x, "shed", "far").alive);
          });
}
