// Hosts whose init runs components: peers in virtual time, and a process in wall time.
#include <filesystem>
#include <optional>
#include <vector>

#include <unistd.h>

#include "ecology/ecology_files.hpp"
#include "io/files/file_lock.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// When somebody is told to have done exactly that.
std::vector<instant> times(const report::run_report& x, std::string_view who,
                           std::string_view what) {
  std::vector<instant> found;
  for (const auto& line : x.event_log) {
    if (line.who == who && line.what == what)
      found.push_back(line.at);
  }
  return found;
}

/// The first of them that is not before `from`.
instant time_of(const report::run_report& x, std::string_view who, std::string_view what,
                instant from = {}) {
  for (const auto at : times(x, who, what)) {
    if (at >= from)
      return at;
  }
  throw std::runtime_error(std::string(who) + " never told: " + std::string(what));
}

double figure(const report::run_report& x, std::string_view who, std::string_view name) {
  for (const auto& program : x.programs) {
    if (program.who != who || program.kind != "init")
      continue;
    for (const auto& [each, value] : program.figures) {
      if (each == name)
        return value;
    }
  }
  return -1;
}

report::run_report run_in_wall_time(const std::string& toml) {
  auto x = run(describe(toml));
  CHECK(x.mode == "wall");
  return x;
}

std::string temporary(const std::string& name) {
  return (std::filesystem::temp_directory_path() / (name + '-' + std::to_string(::getpid())))
      .string();
}

} // namespace

TEST_CASE("components are started and stopped from another computer by tuples alone",
          "[ecology][peisinit][SVC-01][SVC-03][SVC-04][SVC-05][LEA-02]") {
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    const auto x = run(example("scenarios/peis/components.toml"), seed);
    for (const auto& each : x.violations)
      UNSCOPED_INFO(each.invariant << ": " << each.detail);
    for (const auto& line : x.event_log)
      UNSCOPED_INFO(to_text(line.at) << ' ' << line.who << ": " << line.what);
    CHECK(x.violations.empty());

    // The dark of the second minute ends the rules, and the light brings them back.
    CHECK(time_of(x, "care-init", "rules on") < instant(1s));
    const auto off = time_of(x, "care-init", "rules off");
    CHECK(off >= instant(61s));
    CHECK(off < instant(75s));
    const auto on = time_of(x, "care-init", "rules on", off);
    CHECK(on >= instant(121s));
    CHECK(on < instant(135s));

    // The planner is off until somebody wants it. It stands still when it is to end.
    CHECK(time_of(x, "care-init", "planner on") > instant(1s));
    const auto asked = time_of(x, "care-init", "planner is to end", instant(140s));
    CHECK(asked >= instant(151s));
    CHECK(time_of(x, "care-init", "planner is killed") == asked + 2s);
    const auto gone = time_of(x, "care-init", "planner off", asked);
    CHECK(gone - asked < 4s);

    // A crash loop is slow.
    const auto ends = times(x, "care-init", "logger has ended, again in 5 s");
    CHECK(ends.size() >= 3);
    for (const auto end : ends)
      CHECK(time_of(x, "care-init", "logger on", end) >= end + 5s);
    CHECK(figure(x, "care-init", "unwanted ends") == static_cast<double>(ends.size()));
    CHECK(figure(x, "care-init", "killed") == 1);
    CHECK(figure(x, "care-init", "components on") == 1);

    // The components are leaves: their host's traffic goes through the init.
    for (const auto& peer : x.peers) {
      CAPTURE(peer.name);
      if (peer.name.starts_with("care-") && peer.name != "care-init" && peer.alive)
        CHECK(peer.links == 1);
    }
  }
}

TEST_CASE("the trace of an ecology with components is the same each time",
          "[ecology][peisinit][GEN-07]") {
  auto what = example("scenarios/peis/components.toml");
  what.length = 80s;
  CHECK(run(what, 7).trace_hash == run(what, 7).trace_hash);
}

TEST_CASE("with its init a whole host ends and comes back", "[ecology][peisinit][SVC-01]") {
  auto what = example("scenarios/peis/components.toml");
  what.length = 50s;
  what.faults = {{10s, config::kill_fault{peer_id{40}, 20s}}};
  const auto x = run(what);
  CHECK(x.violations.empty());
  CHECK(has_logged(x, "care-init", "killed for 20 s"));
  CHECK(times(x, "care-init", "rules on").size() == 2);
  CHECK(time_of(x, "care-init", "rules on", instant(10s)) >= instant(30s));
  for (const auto& peer : x.peers) {
    if (peer.name == "care-rules")
      CHECK(peer.incarnations == 2);
  }
}

TEST_CASE("a process is watched, fed, started again and stopped by tuples",
          "[ecology][peisinit][SVC-03][SVC-04][SVC-05]") {
  const auto lock = temporary("rubicon-components");
  const auto x = run_in_wall_time(R"(
[ecology]
name = "processes"
mode = "wall"
duration = "3s"

[[peer]]
id = 1
name = "pc"

[[peer.apps]]
app = "init"
lock = ")" + lock + R"("
components = [
  { name = "asker", command = "printf 42; read a; exit $a", id = "+1", delay = "1h" },
  { name = "crasher", command = "exit 3", id = "+2", delay = "1s" },
  { name = "sleeper", command = "trap '' INT TERM; while :; do sleep 1000; done", id = "+3" },
  { name = "lost", command = "/nowhere/at-all $PEISINIT", id = "+4", delay = "1h" },
]

[[peer]]
id = 10
name = "remote"
links = ["inproc://pc"]

[[peer.apps]]
app = "rules"

[[peer.apps.rules]]
when = "components.asker.stdout"
above = 42
write = "components.asker.stdin"
then = "7"
)");
  for (const auto& line : x.event_log)
    UNSCOPED_INFO(to_text(line.at) << ' ' << line.who << ": " << line.what);
  CHECK(x.actors.failures.empty());
  CHECK(times(x, "pc", "asker on").size() == 1);
  CHECK(times(x, "pc", "asker has ended, status 7, again in 1 h").size() == 1);
  CHECK(times(x, "pc", "lost has ended, status 127, again in 1 h").size() == 1);
  const auto starts = times(x, "pc", "crasher on");
  REQUIRE(starts.size() >= 2);
  CHECK(starts.size() <= 3);
  for (std::size_t i = 1; i < starts.size(); ++i)
    CHECK(starts[i] - starts[i - 1] >= 1s);
  CHECK(times(x, "pc", "sleeper on").size() == 1); // and the run came to its end
  CHECK(x.wall_s < 3 + 4.5);
  std::filesystem::remove(lock);
}

TEST_CASE("a second init of a host refuses to run", "[ecology][peisinit][SVC-06]") {
  const auto path = temporary("rubicon-init-lock");
  {
    const auto held = io::file_lock::take(path);
    REQUIRE(std::holds_alternative<io::file_lock>(held));
    const auto x = run_in_wall_time("[ecology]\nname = \"second\"\nmode = \"wall\"\n"
                                    "duration = \"100ms\"\n[[peer]]\nid = 1\nname = \"pc\"\n"
                                    "apps = [{ app = \"init\", components = [], lock = \"" +
                                    path + "\" }]\n");
    REQUIRE(x.actors.failures.size() == 1);
    CHECK(x.actors.failures[0].find("no second init of host pc: " + path + " is held by process " +
                                    std::to_string(::getpid())) != std::string::npos);
    CHECK_FALSE(x.violations.empty());
  }
  std::filesystem::remove(path);
}
