// Robots that are not there: their faces in the tuple space, wired and put to work from a third
// computer (SVC-10, META-05).
#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// When somebody whose name ends with `who` has told exactly that, in order.
std::vector<instant> times(const report::run_report& x, std::string_view who,
                           std::string_view what) {
  std::vector<instant> found;
  for (const auto& line : x.event_log) {
    if (line.who.ends_with(who) && line.what == what)
      found.push_back(line.at);
  }
  return found;
}

std::size_t between(const std::vector<instant>& all, instant from, instant to) {
  return static_cast<std::size_t>(
      std::ranges::count_if(all, [&](const auto at) { return at >= from && at < to; }));
}

/// The figures of the program of kind `goal` on a peer, in its last life.
std::map<std::string, double> figures(const report::run_report& x, std::string_view who) {
  for (const auto& program : x.programs) {
    if (program.who == who && program.kind == "goal")
      return {program.figures.begin(), program.figures.end()};
  }
  throw std::runtime_error("no goals of " + std::string(who));
}

void show(const report::run_report& x) {
  for (const auto& each : x.violations)
    UNSCOPED_INFO(each.invariant << ": " << each.detail);
  for (const auto& line : x.event_log)
    UNSCOPED_INFO(to_text(line.at) << ' ' << line.who << ": " << line.what);
}

void check_outcomes(const report::run_report& x) {
  for (const auto* who : {"carrier", "opener"}) {
    CAPTURE(who);
    auto all = figures(x, who);
    CHECK(all["goals"] == all["succeeded"] + all["failed"] + all["preempted"] + all["open"]);
    CHECK(all["unknown"] == 0);
  }
}

/// Goals of a robot that have begun, and outcomes of each kind, as the event log has them.
std::size_t goals_told(const report::run_report& x, std::string_view who, std::string_view how) {
  return static_cast<std::size_t>(std::ranges::count_if(x.event_log, [&](const auto& line) {
    return line.who == who && line.what.find(how) != std::string::npos;
  }));
}

/// When rules wrote that, for the first time or again.
std::vector<instant> wirings(const report::run_report& x, const std::string& what) {
  auto all = times(x, "rules-1", "writes " + what);
  std::ranges::copy(times(x, "rules-1", "writes " + what + " again"), std::back_inserter(all));
  std::ranges::sort(all);
  return all;
}

} // namespace

TEST_CASE("two robots work together as a third computer has wired them",
          "[ecology][SVC-10][META-05]") {
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    const auto x = run(example("scenarios/robots.toml"), seed);
    show(x);
    CHECK(x.violations.empty());
    check_outcomes(x);

    // Each is wired to the other once it is known, and the opener once more after its computer was
    // off.
    CHECK(wirings(x, "carrier.mi-door = (META 32 opener.door)").size() == 1);
    const auto wired = wirings(x, "opener.mi-visitor = (META 31 carrier.place)");
    CHECK(between(wired, {}, instant(2min)) == 1);
    CHECK(between(wired, instant(210s), instant(6min)) == 1);

    // Only behind an open door is the kitchen, and only with a visitor there does the opener close
    // it.
    const auto arrived = times(x, "carrier", "at kitchen succeeded");
    const auto opened = times(x, "opener", "open the door succeeded");
    const auto closed = times(x, "opener", "close the door succeeded");
    CHECK(between(arrived, {}, instant(2min)) >= 1);
    CHECK(between(arrived, instant(210s), instant(6min)) >= 1);
    REQUIRE(!opened.empty());
    for (const auto at : arrived)
      CHECK(between(opened, at - 60s, at) >= 1);
    CHECK(!closed.empty());
    for (const auto at : closed)
      CHECK(between(arrived, at - 30s, at) == 1);

    // One's outcome is the other's goal, a moment later. Guarding ends only by that.
    const auto guarding = times(x, "opener", "goal: guard the door");
    for (const auto at : guarding)
      CHECK(between(opened, at - 100ms, at + 1ns) == 1);
    const auto wanted = times(x, "opener", "goal: close the door");
    CHECK(!wanted.empty());
    for (const auto at : wanted)
      CHECK(between(arrived, at - 100ms, at) == 1);
    CHECK(times(x, "opener", "guard the door succeeded").empty());
    CHECK(!times(x, "opener", "guard the door preempted: newer").empty());

    // Without the opener the carrier waits in vain, until its time is up.
    const auto failed = times(x, "carrier", "at kitchen failed: timeout");
    CHECK(between(failed, instant(2min), instant(210s)) >= 1);
    for (const auto at : failed)
      CHECK(times(x, "carrier", "goal: at kitchen").front() <= at - 40s);
    CHECK(goals_told(x, "carrier", "goal: ") ==
          goals_told(x, "carrier", " succeeded") + goals_told(x, "carrier", " failed") +
              goals_told(x, "carrier", " preempted") +
              static_cast<std::size_t>(figures(x, "carrier")["open"]));
  }
}

TEST_CASE("robots that cannot hear each other fail in time, and go on when they can",
          "[ecology][SVC-10][META-05]") {
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    auto what = example("scenarios/robots.toml");
    what.faults = {{100s, config::partition_fault{{{peer_id{31}}}, 80s}}};
    const auto x = run(what, seed);
    show(x);
    CHECK(x.violations.empty());
    check_outcomes(x);
    const auto arrived = times(x, "carrier", "at kitchen succeeded");
    CHECK(between(arrived, {}, instant(100s)) >= 1);
    CHECK(between(arrived, instant(115s), instant(180s)) == 0);
    CHECK(between(arrived, instant(180s), instant(6min)) >= 1);
    // It is alone, and nobody tells it what to do: what it was about has its outcome, and that is
    // all.
    CHECK(between(times(x, "carrier", "goal: at kitchen"), instant(110s), instant(180s)) == 0);
    CHECK(between(times(x, "carrier", "goal: at dock"), instant(110s), instant(180s)) == 0);
  }
}

TEST_CASE("a robot that is started again at once is wired again", "[ecology][SVC-10][META-05]") {
  for (const auto length : {100ms, 2000ms, 20000ms}) {
    CAPTURE(length.count());
    auto what = example("scenarios/robots.toml");
    what.faults = {{70s, config::kill_fault{peer_id{31}, length}}};
    what.length = 4min;
    const auto x = run(what, 3);
    show(x);
    CHECK(x.violations.empty());
    check_outcomes(x);
    const auto wired = wirings(x, "carrier.mi-door = (META 32 opener.door)");
    CHECK(between(wired, {}, instant(70s)) == 1);
    CHECK(between(wired, instant(70s), instant(100s)) == 1);
    CHECK(between(times(x, "carrier", "at kitchen succeeded"), instant(70s), instant(4min)) >= 1);
  }
}

TEST_CASE("the trace of robots is the same each time", "[ecology][SVC-10][GEN-07]") {
  auto what = example("scenarios/robots.toml");
  what.length = 1min;
  CHECK(run(what, 7).trace_hash == run(what, 7).trace_hash);
  CHECK(run(what, 7).trace_hash != run(what, 8).trace_hash);
}

namespace {

/// A lamp in the hall, and two switches on other computers: the left one says on and off in turn,
/// the right one only off. At first the lamp follows the left one.
constexpr std::string_view lamp = R"(
[ecology]
name = "lamp"
duration = "3min"
[[island]]
id = 1
name = "hall"
gateway.links = ["inproc://pc"]
[[island.mote]]
id = 2
name = "lamp"
type = 20
position_m = [3, 0]
actuators = [{ name = "switch", kind = "relay" }]
apps = [{ app = "actuator", actuator = "switch" }]
[[peer]]
id = 11
name = "pc"
links = ["inproc://planner"]
apps = [{ app = "proxy_manager" }]
[[peer]]
id = 31
name = "left"
links = ["inproc://planner"]
[[peer.apps]]
app = "goal"
outputs = [{ name = "light", value = "off", every = "10min" }]
goals = [{ goal = "blink", timeout = "1min", states = [
  { state = "dark", for = "5s", sets = { light = "on" } },
  { state = "bright", for = "5s", sets = { light = "off" } }] }]
[[peer]]
id = 32
name = "right"
links = ["inproc://planner"]
[[peer.apps]]
app = "goal"
outputs = [{ name = "light", value = "off", every = "10min" }, { name = "hour", value = 0, every = "1min", step = 1 }]
goals = [{ goal = "shine", timeout = "1min", states = [
  { state = "dark", for = "5s", sets = { light = "on" } }] }]
[[peer]]
id = 40
name = "planner"
[[peer.apps]]
app = "rules"
retry = "0s"
[[peer.apps.rules]]
when = "left.state"
equals = ["idle"]
write = "left.goal"
then = "blink"
[[peer.apps.rules]]
when = "right.hour"
above = 1
point = "hall.lamp.mi-switch"
otherwise = "left:left.light"
then = "right:right.light"
[[peer.apps.rules]]
when = "right.hour"
above = 2
write = "right.goal"
then = "shine"
[[proxy]]
name = "lamp"
types = [20]
[[proxy.input]]
name = "switch"
channel = 2
meta = true
words = { on = "01", off = "00" }
)";

} // namespace

TEST_CASE("an actuator's input is pointed at another tuple while it runs, and follows that alone",
          "[ecology][META-05][PXY-12]") {
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    const auto x = run(describe(lamp), seed);
    show(x);
    CHECK(x.violations.empty());
    const auto pointed = wirings(x, "hall.lamp.mi-switch = (META 32 right.light)");
    REQUIRE(pointed.size() == 1);
    const auto turn = pointed.front();
    CHECK(turn > instant(1min));
    CHECK(turn < instant(61s));

    // Until then it follows the left one, on and off every ten seconds.
    const auto on = times(x, "hall/lamp", "switch on");
    const auto off = times(x, "hall/lamp", "switch off");
    CHECK(between(on, {}, turn) >= 4);
    CHECK(between(off, {}, turn) >= 4);
    // Then the right one: off until the second minute, from then on on. The left one blinks on.
    CHECK(between(on, turn + 1s, instant(2min)) == 0);
    CHECK(between(off, turn + 1s, instant(3min)) == 0);
    CHECK(between(on, instant(2min), instant(130s)) == 1);
    CHECK(between(on, instant(2min), instant(3min)) == 1);
    CHECK(between(times(x, "left", "blink succeeded"), turn, instant(3min)) >= 8);
    const auto& actuations = proxy_of(x, "hall.lamp").actuations;
    CHECK(actuations.requested == actuations.acknowledged + report::total(actuations.failed));
  }
}
