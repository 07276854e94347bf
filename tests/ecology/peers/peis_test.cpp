// Whole PEIS networks under the faults of the plan: config/scenarios/peis, a few seeds each.
#include <set>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

report::run_report run_scenario(const std::string& name, std::uint64_t seed,
                                std::optional<duration> length = std::nullopt) {
  auto what = example("scenarios/peis/" + name + ".toml");
  what.length = length.value_or(what.length);
  auto report = run(what, seed);
  for (const auto& x : report.violations)
    UNSCOPED_INFO(x.invariant << ": " << x.detail);
  CHECK(report.violations.empty()); // among them: all know whom they reach, and nobody else
  return report;
}

std::set<std::int32_t> clusters(const report::run_report& x) {
  std::set<std::int32_t> found;
  for (const auto& peer : x.peers) {
    if (peer.alive)
      found.insert(peer.cluster);
  }
  return found;
}

std::uint64_t hosts_known_min(const report::run_report& x) {
  std::uint64_t least = UINT64_MAX;
  for (const auto& peer : x.peers) {
    if (peer.alive)
      least = std::min(least, peer.hosts_known);
  }
  return least;
}

const report::peer_report& peer_of(const report::run_report& x, std::string_view name) {
  const auto found = std::ranges::find(x.peers, name, &report::peer_report::name);
  if (found == x.peers.end())
    throw std::runtime_error("no peer " + std::string(name));
  return *found;
}

std::uint64_t links_opened(const report::run_report& x) {
  std::uint64_t sum = 0;
  for (const auto& peer : x.peers)
    sum += peer.links_opened;
  return sum;
}

} // namespace

TEST_CASE("thirty peers on one LAN find each other and keep 3 to 7 links each",
          "[ecology][peis][CM-01][CLU-01]") {
  for (std::uint64_t seed = 1; seed <= seeds(4); ++seed) {
    CAPTURE(seed);
    const auto x = run_scenario("lan", seed);
    CHECK(hosts_known_min(x) == 30);
    CHECK(clusters(x) == std::set<std::int32_t>{101});
    for (const auto& peer : x.peers) {
      CAPTURE(peer.name);
      CHECK(peer.links >= 3);
      CHECK(peer.links <= 7);
    }
    // Settled within a minute: from then on less than one change a minute.
    const auto early = run_scenario("lan", seed, 1min);
    CHECK(hosts_known_min(early) == 30);
    CHECK(links_opened(x) <= links_opened(early) + 4);
  }
}

TEST_CASE("a large network settles: then no link opens", "[ecology][peis][CM-01]") {
  auto what = example("scenarios/peis/lan.toml");
  while (what.peers.size() < 250) {
    auto next = what.peers.front();
    next.id = peer_id{static_cast<std::int32_t>(1000 + what.peers.size())};
    next.name = "p" + std::to_string(what.peers.size());
    what.peers.push_back(std::move(next));
  }
  const auto opened_after = [&](duration length) {
    what.length = length;
    const auto x = run(what, 1);
    CHECK(x.violations.empty());
    CHECK(hosts_known_min(x) == 250);
    return links_opened(x);
  };
  // Links too many are closed 10 to 20 s after they were chosen, and some of their ends need
  // another afterwards (docs/peis-wire.md 14).
  CHECK(opened_after(135s) == opened_after(165s));
}

TEST_CASE("a network in two parts has two clusters and is one again when it heals",
          "[ecology][peis][CLU-01][CLU-02]") {
  for (std::uint64_t seed = 1; seed <= seeds(4); ++seed) {
    CAPTURE(seed);
    const auto before = run_scenario("partition", seed, 59s);
    CHECK(clusters(before) == std::set<std::int32_t>{11});
    const auto parted = run_scenario("partition", seed, 119s);
    CHECK(clusters(parted) == std::set<std::int32_t>{11, 21});
    CHECK(hosts_known_min(parted) == 6);
    const auto healed = run_scenario("partition", seed, 130s); // CLU-02: within 10 s
    CHECK(clusters(healed) == std::set<std::int32_t>{11});
    CHECK(hosts_known_min(run_scenario("partition", seed)) == 12);
  }
}

TEST_CASE("without managers a line stays a line", "[ecology][peis][CM-12]") {
  for (std::uint64_t seed = 1; seed <= seeds(4); ++seed) {
    CAPTURE(seed);
    const auto x = run_scenario("line", seed);
    CHECK(hosts_known_min(x) == 6);
    CHECK(links_opened(x) == 2 * 5);
    CHECK(peer_of(x, "a").links == 1);
    CHECK(peer_of(x, "c").links == 2);
    CHECK(peer_of(x, "f").links == 1);
  }
}

TEST_CASE("every leaf has exactly one link", "[ecology][peis][LEA-01]") {
  for (std::uint64_t seed = 1; seed <= seeds(4); ++seed) {
    CAPTURE(seed);
    const auto x = run_scenario("star", seed);
    CHECK(hosts_known_min(x) == 21);
    for (const auto& peer : x.peers) {
      CAPTURE(peer.name);
      CHECK(peer.links == (peer.name == "master" ? 20 : 1));
    }
  }
}

TEST_CASE("a ring that loses every tenth package stays together", "[ecology][peis]") {
  for (std::uint64_t seed = 1; seed <= seeds(4); ++seed) {
    CAPTURE(seed);
    const auto x = run_scenario("ring", seed);
    // A link that was silent for too long may just have been closed, and what was routed over it
    // forgotten: the other side of the ring makes up for it.
    CHECK(std::max(hosts_known_min(x), hosts_known_min(run_scenario("ring", seed, 315s))) == 8);
    CHECK(clusters(x) == std::set<std::int32_t>{1});
    for (const auto& peer : x.peers) {
      CAPTURE(peer.name);
      CHECK(peer.links == 2);
      CHECK(peer.peis.lost.at("network") > 0);
      CHECK(peer.peis.lost.at("illegal") == 0);
    }
  }
}

TEST_CASE("who is killed is forgotten, and known again when it is back",
          "[ecology][peis][KH-05][RTE-07][RTE-08]") {
  for (std::uint64_t seed = 1; seed <= seeds(4); ++seed) {
    CAPTURE(seed);
    const auto gone = run_scenario("restart", seed, 79s); // pc-1 is down since 60 s
    CHECK(!peer_of(gone, "pc-1").alive);
    CHECK(hosts_known_min(gone) == 9);
    const auto silent = run_scenario("restart", seed, 145s); // pc-2 is without power since 120 s
    CHECK(!peer_of(silent, "pc-2").alive);
    CHECK(peer_of(silent, "pc-1").incarnations == 2);
    for (const auto& peer : silent.peers) {
      CAPTURE(peer.name);
      CHECK((!peer.alive || peer.hosts_known == 9));
    }
    const auto x = run_scenario("restart", seed);
    CHECK(!peer_of(x, "robot").alive);
    CHECK(hosts_known_min(x) == 9);
    CHECK(clusters(x).size() == 1);
    CHECK(x.actors.restarted == 7);
    CHECK(x.actors.failures.empty());
    CHECK(has_logged(x, "pc-2", "power off for 30 s"));
    CHECK(has_logged(x, "pc-2", "started again, life 2"));
  }
}

TEST_CASE("peers on hosts of their own talk through their masters", "[ecology][peis][LEA-02]") {
  std::string text = "[ecology]\nname = \"stars\"\nduration = \"2min\"\n";
  for (int host = 1; host <= 3; ++host) {
    const auto name = "host-" + std::to_string(host);
    const auto master = "master-" + std::to_string(host);
    text += "[[host]]\nname = \"" + name + "\"\naddress = \"10.0.0." + std::to_string(host) +
            "\"\n[[peer]]\nid = " + std::to_string(host) + "\nname = \"" + master +
            "\"\nhost = \"" + name + "\"\n[[peer]]\nid = " + std::to_string(100 * host) +
            "\nname = \"leaf-" + std::to_string(host) + "\"\ncount = 20\nleaf = true\nhost = \"" +
            name + "\"\nlinks = [\"inproc://" + master + "\"]\n";
  }
  const auto x = run(describe(text));
  CHECK(x.violations.empty());
  CHECK(hosts_known_min(x) == 63);
  CHECK(clusters(x) == std::set<std::int32_t>{1});
  for (const auto& peer : x.peers) {
    CAPTURE(peer.name);
    const bool leaf = peer.name.starts_with("leaf");
    CHECK(peer.links >= (leaf ? 1U : 21U));
    CHECK(peer.links <= (leaf ? 1U : 22U));
  }
}

TEST_CASE("two processes with one id are noticed and go again", "[ecology][peis][RTE-08][IF-12]") {
  auto what = describe("[ecology]\nname = \"two\"\nduration = \"5min\"\n"
                       "[[peer]]\nid = 1\nname = \"pc\"\ncount = 5\n"
                       "[[fault]]\nat = \"1min\"\nkind = \"duplicate_id\"\npeer = \"pc-3\"\n"
                       "for = \"30s\"\n");
  const auto x = run(what);
  CHECK(x.violations.empty());
  CHECK(has_logged(x, "pc-3", "a second one with its id appears for 30 s"));
  CHECK(hosts_known_min(x) == 5);
}

TEST_CASE("a gateway that is killed comes back with its island", "[ecology][peis][ACT-04]") {
  auto home = example("home.toml");
  home.faults = {{2min, config::kill_fault{peer_id{1}, 20s}}};
  const auto x = run(home);
  for (const auto& each : x.violations)
    UNSCOPED_INFO(each.invariant << ": " << each.detail);
  CHECK(x.violations.empty());
  CHECK(has_logged(x, "kitchen-gateway", "killed for 20 s"));
  CHECK(peer_of(x, "kitchen-gateway").incarnations == 2);
  CHECK(proxy_of(x, "kitchen.fan").status == "active");
}

TEST_CASE("a PC that is killed comes back with its proxies", "[ecology][peis][ACT-04]") {
  auto home = example("home.toml");
  home.faults.insert(home.faults.begin(), {2min, config::kill_fault{peer_id{11}, 20s}});
  const auto x = run(home);
  for (const auto& each : x.violations)
    UNSCOPED_INFO(each.invariant << ": " << each.detail);
  CHECK(x.violations.empty());
  CHECK(proxy_of(x, "kitchen.fan").status == "active");
  CHECK(value(proxy_of(x, "kitchen.climate-7"), "temperature") != "");
}

TEST_CASE("with faults of every kind at random moments peers find together again",
          "[ecology][peis][ACT-04]") {
  auto what = describe(R"(
[ecology]
name = "storm"
duration = "8min"
[[peer]]
id = 1
name = "pc"
count = 9
[[peer]]
id = 50
name = "robot"
links = ["inproc://pc-1"]
[[fault]]
random = 4
until = "5min"
kind = "kill"
peer = "*"
for = "10s"
[[fault]]
random = 2
until = "5min"
kind = "power_off"
peer = "*"
for = "20s"
[[fault]]
random = 3
until = "5min"
kind = "pause"
peer = "*"
for = "7s"
[[fault]]
random = 2
until = "5min"
kind = "partition"
groups = [["pc-1", "pc-2", "pc-3"], ["pc-4", "robot"]]
for = "15s"
[[fault]]
every = "1min"
until = "4min"
kind = "link_loss"
loss = 0.3
for = "20s"
[[fault]]
random = 2
until = "5min"
kind = "clock_step"
peer = "*"
by = "-5s"
)");
  for (std::uint64_t seed = 1; seed <= seeds(4); ++seed) {
    CAPTURE(seed);
    const auto x = run(what, seed);
    for (const auto& each : x.violations)
      UNSCOPED_INFO(each.invariant << ": " << each.detail);
    CHECK(x.violations.empty());
    CHECK(hosts_known_min(x) == 10);
    CHECK(clusters(x) == std::set<std::int32_t>{1});
    CHECK(run(what, seed).trace_hash == x.trace_hash); // GEN-07
  }
}
