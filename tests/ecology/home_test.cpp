#include <set>

#include "ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

TEST_CASE("the home tells all that happens", "[ecology][GEN-04][IF-07][RTG-02][PXY-16]") {
  const auto report = run(example("home.toml"));
  CHECK(report.violations.empty());

  // Everybody joins, and is listed with a proxy of the right kind.
  CHECK(report.motes_configured() >= 12);
  CHECK(report.motes_joined() == report.motes_configured());
  CHECK(proxy_of(report, "kitchen.climate-7").proxy_class == "climate");
  CHECK(proxy_of(report, "kitchen.presence-2").proxy_class == "presence");
  CHECK(proxy_of(report, "kitchen.fan").proxy_class == "relay");

  // Readings have become meaning, with unit.
  const auto temperature = value(proxy_of(report, "kitchen.climate-7"), "temperature");
  CHECK(temperature.ends_with(" C"));
  CHECK(std::stod(temperature) == Approx(22.5).margin(0.6));

  // The kitchen gets too warm: the fan goes on, and off when it is cooler again.
  CHECK(has_logged(report, "rules-1", "writes kitchen.fan.switch = on"));
  CHECK(has_logged(report, "kitchen/fan", "switch on"));
  CHECK(value(proxy_of(report, "kitchen.fan"), "state") == "off");
  const auto& fan = proxy_of(report, "kitchen.fan").actuations;
  CHECK(fan.requested >= 2);
  CHECK(fan.acknowledged >= 2);

  // The milk is carried to the bed, and back after the lamp has reminded of it.
  CHECK(has_logged(report, "things.milk", "seen by the reader bed"));
  CHECK(has_logged(report, "rules-1", "writes bedroom.lamp.switch = on"));
  CHECK(has_logged(report, "bedroom/lamp", "switch on"));
  CHECK(value(proxy_of(report, "things.milk"), "interface") == "fridge");
  CHECK(value(proxy_of(report, "things.milk"), "litres") == "1.0 l");
  CHECK(value(proxy_of(report, "bedroom.lamp"), "state") == "off");

  // The kitchen's gateway crashes; its motes are back at once when it is.
  CHECK(has_logged(report, "kitchen-gateway", "killed"));
  for (const auto& line : report.event_log) {
    const bool again = line.who.starts_with("kitchen/") && line.what.starts_with("joined again");
    CHECK((!again || line.at < instant(322s)));
  }

  // A mote of one island is heard by a mote of the other.
  CHECK(has_logged(report, "listener-10", "received \"dinner\" from mote 1/8"));

  // A battery ends; the mote leaves and its proxy is lost.
  CHECK(has_logged(report, "bedroom/presence-3", "battery flat"));
  CHECK(has_logged(report, "bedroom/presence-3", "left: battery"));
  CHECK(proxy_of(report, "bedroom.presence-3").status == "lost");
  CHECK(report.motes_alive() == report.motes_configured() - 1);
  CHECK(report.motes_left() == 1);

  // Every reliable message has one outcome.
  const auto messages = report.messages();
  CHECK(messages.reliable_sent ==
        messages.reliable_acked + messages.reliable_failed + messages.reliable_open);
  CHECK(messages.reliable_failed <= 3); // to and from the crashed gateway
}

TEST_CASE("equal seeds give equal runs, other seeds other runs", "[ecology][GEN-07][ACT-05]") {
  auto home = example("home.toml");
  home.length = 3min;
  std::set<std::string> hashes;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    auto first = run(home, seed);
    auto second = run(home, seed);
    first.wall_s = second.wall_s = 0;
    CHECK(report::to_json(first) == report::to_json(second));
    hashes.insert(first.trace_hash);
  }
  CHECK(hashes.size() == 4);
}

TEST_CASE("an ecology can be stopped after any time", "[ecology]") {
  auto home = example("home.toml");
  for (const auto length : {duration(1ms), duration(500ms), duration(3s), duration(17s)}) {
    home.length = length;
    const auto report = run(home);
    CHECK(report.simulated == length);
    CHECK(report.violations.empty());
  }
}
