#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

std::uint32_t incarnations(const report::run_report& x, mote_address mote) {
  for (const auto& island : x.islands) {
    for (const auto& entry : island.motes) {
      if (entry.address == mote)
        return entry.incarnations;
    }
  }
  return 0;
}

} // namespace

TEST_CASE("a throwing mote is restarted, alone, and the report says so", "[ecology][ACT-03]") {
  auto home = example("home.toml");
  const mote_address fan{island_id{1}, mote_id{4}};
  home.faults.insert(home.faults.begin(), {2min, config::crash_fault{fan}});
  const auto report = run(home);
  CHECK(report.violations.empty());
  CHECK(report.actors.restarted == 2);   // with the gateway that home.toml kills
  CHECK(report.actors.failures.empty()); // it was to throw
  CHECK(has_logged(report, "kitchen/fan", "crashed as planned"));
  for (const auto& island : report.islands) {
    for (const auto& mote : island.motes)
      CHECK(mote.incarnations == (mote.address == fan ? 2 : 1));
  }
  CHECK(has_logged(report, "kitchen/fan", "joined again, life 2"));
  // It still obeys in its second life, through the same proxy (DIS-07).
  CHECK(has_logged(report, "kitchen/fan", "switch on"));
  CHECK(proxy_of(report, "kitchen.fan").status == "active");
  CHECK(proxy_of(report, "kitchen.fan").actuations.acknowledged ==
        proxy_of(report, "kitchen.fan").actuations.requested);
}

TEST_CASE("a mote that dies just before the end may still be listed", "[ecology][DIS-06]") {
  auto home = example("home.toml");
  home.faults.push_back({home.length - 2s, config::battery_end_fault{{island_id{1}, mote_id{6}}}});
  const auto report = run(home);
  CHECK(report.violations.empty());
  CHECK(report.motes_alive() == report.motes_configured() - 2);
}

TEST_CASE("motes survive an unplugged cable without joining again", "[ecology][GW-15]") {
  auto home = example("home.toml");
  home.faults.insert(home.faults.begin(), {1min, config::unplug_fault{island_id{1}, 30s}});
  const auto report = run(home);
  CHECK(report.violations.empty());
  CHECK(has_logged(report, "kitchen", "serial cable unplugged"));
  CHECK(has_logged(report, "kitchen", "serial cable plugged in again"));
  for (std::uint16_t mote = 2; mote <= 8; ++mote)
    CHECK(incarnations(report, {island_id{1}, mote_id{mote}}) == 1);
  CHECK(report.islands.at(0).serial.lost.at("unplugged_octets") > 0);
  CHECK(report.motes_joined() == report.motes_configured());
}

TEST_CASE("with a lossy radio and a noisy cable every actuation has one outcome and the invariants "
          "hold",
          "[ecology][IF-07][GW-16]") {
  auto home = example("home.toml");
  home.radio.loss = 0.2;
  for (auto& island : home.islands)
    island.serial.octet_error = 0.001;
  std::uint64_t requested = 0;
  for (std::uint64_t seed = 1; seed <= seeds(10); ++seed) {
    const auto report = run(home, seed);
    CAPTURE(seed);
    for (const auto& x : report.violations)
      UNSCOPED_INFO(x.invariant << ": " << x.detail);
    CHECK(report.violations.empty());
    CHECK(report.motes_joined() == report.motes_configured());
    for (const auto& x : report.proxies) {
      requested += x.actuations.requested;
      CHECK(x.actuations.requested ==
            x.actuations.acknowledged + report::total(x.actuations.failed));
    }
  }
  CHECK(requested >= 2 * seeds(10));
}
