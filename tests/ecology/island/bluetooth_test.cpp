// Peers that meet over simulated Bluetooth: config/scenarios/peis/bluetooth.toml and variants of
// it.
#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

constexpr std::string_view scenario = "scenarios/peis/bluetooth.toml";
constexpr peer_id pc{1};
constexpr peer_id helper{2};
constexpr peer_id robot{30};
constexpr position near_desk{5, 0, 0};
constexpr position far_away{50, 0, 0};

report::run_report run_until(config::ecology_description what, duration end,
                             std::uint64_t seed = 1) {
  what.length = end;
  auto report = run(what, seed);
  for (const auto& x : report.violations)
    UNSCOPED_INFO(x.invariant << ": " << x.detail);
  CHECK(report.violations.empty());
  return report;
}

const report::peer_report& peer_of(const report::run_report& x, std::string_view name) {
  const auto found = std::ranges::find(x.peers, name, &report::peer_report::name);
  if (found == x.peers.end())
    throw std::runtime_error("no peer " + std::string(name));
  return *found;
}

/// The robot is far away for a minute, and the peer that announces is killed meanwhile. The other
/// one makes no links by itself, which it still could.
config::ecology_description without_announcer(std::optional<duration> killed_for) {
  auto what = example(scenario);
  for (auto& peer : what.peers) {
    peer.manager = peer.id != helper;
    if (peer.id == robot)
      peer.place = far_away;
  }
  what.faults = {{30s, config::kill_fault{pc, killed_for}},
                 {60s, config::move_fault{robot, near_desk}}};
  return what;
}

} // namespace

TEST_CASE("peers connect over Bluetooth within range and lose each other when moved apart",
          "[ecology][peis][BT-02][BT-05]") {
  const auto what = example(scenario);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    const auto together = run_until(what, 119s, seed);
    CHECK(peer_of(together, "robot").links >= 1);
    CHECK(peer_of(together, "robot").hosts_known == 3);
    CHECK(peer_of(together, "helper").hosts_known == 3);
    CHECK(peer_of(together, "robot").cluster == 1);
    const auto apart = run_until(what, 130s, seed);
    CHECK(has_logged(apart, "robot", "carried to 50, 0"));
    CHECK(peer_of(apart, "robot").links == 0);
    CHECK(peer_of(apart, "robot").hosts_known == 1);
    CHECK(peer_of(apart, "pc").hosts_known == 2); // the wired ones
    const auto tries = peer_of(apart, "robot").attempts;
    CHECK(peer_of(run_until(what, 239s, seed), "robot").attempts == tries); // nobody is near
    const auto back = run_until(what, what.length, seed);
    CHECK(peer_of(back, "robot").hosts_known == 3);
    CHECK(peer_of(back, "pc").hosts_known == 3);
  }
}

TEST_CASE("who is seen too weakly is never tried", "[ecology][peis][BT-06]") {
  auto what = example(scenario);
  const auto x = run_until(what, 2min);
  CHECK(peer_of(x, "attic").attempts == 0);
  CHECK(peer_of(x, "attic").hosts_known == 1);
  what.peis.bluetooth.threshold_dbm = -69; // 9 m
  const auto y = run_until(what, 2min);
  CHECK(peer_of(y, "attic").attempts + peer_of(y, "pc").attempts >
        peer_of(x, "attic").attempts + peer_of(x, "pc").attempts);
  CHECK(peer_of(y, "attic").hosts_known == 4);
}

TEST_CASE("when the peer that announces is killed, others of its adapter are found no more",
          "[ecology][peis][BT-03]") {
  const auto x = run_until(without_announcer(std::nullopt), 170s);
  CHECK(!peer_of(x, "pc").alive);
  CHECK(peer_of(x, "robot").attempts == 0);
  CHECK(peer_of(x, "robot").links == 0);
  CHECK(peer_of(x, "helper").links == 0);
  auto taken_over = without_announcer(std::nullopt);
  taken_over.peis.bluetooth.takeover = true;
  const auto y = run_until(taken_over, 170s);
  CHECK(peer_of(y, "robot").attempts > 0);
  CHECK(peer_of(y, "robot").links == 1);
  CHECK(peer_of(y, "helper").links == 1);
  const auto z = run_until(without_announcer(100s), 6min); // it comes back
  CHECK(peer_of(z, "robot").hosts_known == 3);
}

TEST_CASE("Bluetooth runs are equal for equal seeds", "[ecology][peis][BT-02][GEN-07]") {
  const auto what = example(scenario);
  CHECK(run(what, 5).trace_hash == run(what, 5).trace_hash);
}
