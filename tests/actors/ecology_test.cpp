#include "actors/messages/common.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/supervision/ecology.hpp"

#include <algorithm>
#include <stdexcept>

#include "actors/services/proxy_manager.hpp"
#include "config/load.hpp"
#include "report/invariants.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using test::fixture;

namespace {

/// One island with two motes, and a PC with a proxy for each.
constexpr std::string_view kitchen_text = R"(
[ecology]
name = "small"
duration = "5min"

[mote_type.climate]
type = 101
platform = "micaz"
transducers.temperature = { model = "constant", value = 21.5, resolution = 0.1 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "5s" }]

[mote_type.relay]
type = 301
platform = "micaz"
actuators = [{ name = "switch", kind = "relay" }]
apps = [{ app = "actuator", actuator = "switch", channel = 2 }]

[[island]]
id = 1
name = "kitchen"

[island.sink]
platform = "micaz"
position_m = [0, 0]

[[island.mote]]
id = 2
name = "stove"
type = "climate"
position_m = [1, 0]

[[island.mote]]
id = 3
name = "fan"
type = "relay"
position_m = [0, 1]

[[peer]]
id = 11
name = "pc"
links = ["inproc://kitchen-gateway"]
apps = [{ app = "proxy_manager", islands = ["kitchen"] }]

[[proxy]]
name = "climate"
types = [101]

[[proxy.field]]
name = "temperature"
channel = 1
encoding = "i16"
scale = 0.1
unit = "C"

[[proxy]]
name = "relay"
types = [301]

[[proxy.input]]
name = "switch"
channel = 2
words = { on = "01", off = "00" }

[[proxy.field]]
name = "state"
channel = 2
encoding = "u8"
words = { 0 = "off", 1 = "on" }
)";

config::ecology_description described(const std::string& faults) {
  auto found = config::load_text(std::string(kitchen_text) + faults, "small.toml");
  std::string problems;
  for (const auto& x : found.problems)
    problems += to_string(x) + '\n';
  if (!found.ecology)
    throw std::runtime_error(problems);
  return *std::move(found.ecology);
}

std::string fault(const std::string& at, const std::string& kind, const std::string& rest) {
  return "\n[[fault]]\nat = \"" + at + "\"\nkind = \"" + kind + "\"\n" + rest + '\n';
}

/// A run of it.
struct ecology_fixture {
  fixture world;
  report::run_report report;
  root_actor root;

  explicit ecology_fixture(const std::string& faults = {}, std::uint64_t seed = 1) {
    auto description = described(faults);
    description.seed = seed;
    const report_receiver keep = [this](report::run_report& x) { report = x; };
    root = world.spawn_at("ecology/small", ecology, std::move(description), keep, frame_observer{},
                          process_facts{});
  }

  /// Runs on to that time and collects the report.
  const report::run_report& end_at(duration time) {
    world.run_for(time - world.now().time_since_epoch());
    world.send(root, collect_report{});
    world.send(root, deliver_report{});
    return report;
  }

  [[nodiscard]] const report::mote_report& mote(const std::string& name) const {
    const auto& motes = report.islands.at(0).motes;
    const auto found = std::ranges::find(motes, name, &report::mote_report::name);
    REQUIRE(found != motes.end());
    return *found;
  }

  /// When a line of the event log was told, for every time it was.
  [[nodiscard]] std::vector<instant> logged(std::string_view who, std::string_view what) const {
    std::vector<instant> times;
    for (const auto& x : report.event_log) {
      if (x.who == who && x.what == what)
        times.push_back(x.at);
    }
    return times;
  }
};

std::string list_of(const std::vector<report::violation>& violations) {
  std::string text;
  for (const auto& x : violations)
    text += x.invariant + ": " + x.detail + '\n';
  return text;
}

} // namespace

TEST_CASE("a small ecology joins, reports and keeps its invariants",
          "[actors][ecology][GEN-04][ACT-01]") {
  ecology_fixture x;
  CHECK(x.world.run_until([&] { return x.world.logged("event=listed") == 2; }, 5s));
  CHECK(x.world.now() <= instant(2s)); // motes ask within their first second
  const auto& report = x.end_at(5min);
  CHECK(list_of(report.violations).empty());
  CHECK(report.motes_configured() == 2);
  CHECK(report.motes_joined() == 2);
  CHECK(report.motes_alive() == 2);
  CHECK(report.actors.failures.empty());
  CHECK(report.actors.restarted == 0);
  REQUIRE(report.proxies.size() == 2);
  CHECK(report.proxies[0].name == "kitchen.fan");
  CHECK(report.proxies[0].values ==
        std::vector<std::pair<std::string, std::string>>{{"state", "off"}});
  CHECK(report.proxies[1].name == "kitchen.stove");
  CHECK(report.proxies[1].values ==
        std::vector<std::pair<std::string, std::string>>{{"temperature", "21.5 C"}});
  CHECK(report.peers.size() == 2);
  CHECK(report.messages().unreliable_sent >= 58); // every 5 s
  CHECK(x.mote("stove").energy.used_mah > 0);
  CHECK(x.world.ends().empty());
}

TEST_CASE("a crash restarts that mote alone, and everybody else keeps what they know",
          "[actors][ecology][ACT-03][GEN-02]") {
  ecology_fixture x(fault("1min", "crash", "mote = \"kitchen/stove\""));
  const auto& report = x.end_at(5min);
  CHECK(list_of(report.violations).empty());
  CHECK(report.actors.restarted == 1);
  CHECK(report.actors.failures.empty()); // it was to crash
  CHECK(x.world.logged("event=failed") == 0);
  CHECK(x.world.logged("event=crashed actor=mote/kitchen/stove how=\"as planned\"") == 1);
  CHECK(x.logged("kitchen/stove", "crashed as planned").size() == 1);
  CHECK(x.mote("stove").incarnations == 2);
  CHECK(x.mote("stove").alive);
  CHECK(x.mote("stove").left_cause.empty());
  CHECK(x.mote("fan").incarnations == 1);

  const auto again = x.logged("kitchen/stove", "joined again, life 2");
  REQUIRE(again.size() == 1);
  CHECK(again[0] > instant(1min + 500ms));
  CHECK(again[0] < instant(1min + 5s));
  CHECK(x.logged("kitchen/fan", "joined").size() == 1);
  CHECK(x.world.logged("event=started proxy=kitchen.stove") == 1);
  CHECK(x.world.logged("event=started proxy=kitchen.fan") == 1);
  CHECK(report.messages().unreliable_sent >= 56); // two readings of 58 at most were missed
}

TEST_CASE("a program in an actor of its own that ends starts again alone",
          "[actors][ecology][ACT-03][PAR-05]") {
  ecology_fixture x(
      "\n[[island.mote]]\nid = 4\nname = \"shelf\"\ntype = \"climate\"\nposition_m = [1, 1]\n"
      "apps = [{ app = \"stream_reader\", place = \"actor\" }]\n");
  x.world.run_for(1min);
  using root_type = scheduler::shell<ecology_state, root_interface>;
  auto* root = dynamic_cast<root_type*>(&x.root.get());
  REQUIRE(root != nullptr);
  const auto& shelf = root->state.motes.at({island_id{1}, mote_id{4}});
  REQUIRE(shelf.programs.size() == 1);
  post_exit(shelf.programs[0].handle, caf::exit_reason::kill);
  x.world.run_for(1ms);
  CHECK(!shelf.programs[0].handle);
  const auto& report = x.end_at(5min);
  CHECK(shelf.programs[0].handle);
  CHECK(report.actors.restarted == 1);
  REQUIRE(report.actors.failures.size() == 1);
  CHECK(report.actors.failures[0].starts_with("program/kitchen/shelf/stream_reader-1"));
  CHECK(x.logged("kitchen/shelf", "joined").size() + x.logged("shelf", "joined").size() == 1);
  REQUIRE(report.programs.size() == 1);
  CHECK(report.programs[0].who == "kitchen/shelf");
}

TEST_CASE("a mote may crash again and again", "[actors][ecology][ACT-03]") {
  std::string faults;
  for (const auto* const at : {"30s", "60s", "60100ms", "90s"})
    faults += fault(at, "crash", "mote = \"kitchen/fan\"");
  ecology_fixture x(faults);
  const auto& report = x.end_at(5min);
  CHECK(list_of(report.violations).empty());
  CHECK(report.actors.restarted == 3); // one came while the mote was out of order
  CHECK(x.mote("fan").incarnations == 4);
  CHECK(x.mote("fan").alive);
  CHECK(x.mote("stove").incarnations == 1);
  CHECK(x.logged("kitchen/fan", "joined again, life 4").size() == 1);
}

TEST_CASE("a mote whose battery is flat leaves and stays away", "[actors][ecology][ACT-04]") {
  ecology_fixture x(fault("1min", "battery_end", "mote = \"kitchen/stove\"") +
                    fault("2min", "crash", "mote = \"kitchen/stove\""));
  const auto& report = x.end_at(5min);
  CHECK(list_of(report.violations).empty());
  CHECK(!x.mote("stove").alive);
  CHECK(x.mote("stove").joined);
  CHECK(x.mote("stove").left_cause == "battery");
  CHECK(x.mote("stove").incarnations == 1);
  CHECK(x.mote("fan").alive);
  CHECK(report.actors.restarted == 0);
  CHECK(report.actors.failures.empty());
  CHECK(x.logged("kitchen/stove", "battery flat") == std::vector{instant(61s)});
  CHECK(x.logged("kitchen/stove", "left: battery").size() == 1);
  CHECK(x.mote("stove").energy.radio_listen < 1min + 2s);
  REQUIRE(report.proxies.size() == 2);
  CHECK(report.proxies[1].status == "lost");
}

TEST_CASE("a battery that ends while its mote restarts is flat all the same",
          "[actors][ecology][ACT-04]") {
  ecology_fixture x(fault("60s", "crash", "mote = \"kitchen/stove\"") +
                    fault("60200ms", "battery_end", "mote = \"kitchen/stove\""));
  const auto& report = x.end_at(5min);
  CHECK(list_of(report.violations).empty());
  CHECK(!x.mote("stove").alive);
  CHECK(x.mote("stove").incarnations == 1);
  CHECK(report.actors.restarted == 0);
  CHECK(x.logged("kitchen/stove", "battery flat").size() == 1);
  CHECK(x.mote("stove").left_cause == "silence"); // it could not say so
}

TEST_CASE("an island recovers from ten seconds without its cable", "[actors][ecology][ACT-04]") {
  ecology_fixture x(fault("1min", "unplug", "island = \"kitchen\"\nfor = \"10s\""));
  const auto& report = x.end_at(5min);
  CHECK(list_of(report.violations).empty());
  CHECK(x.logged("kitchen", "serial cable unplugged") == std::vector{instant(60s)});
  CHECK(x.logged("kitchen", "serial cable plugged in again") == std::vector{instant(70s)});
  CHECK(report.serial().lost.at("unplugged_octets") > 0);
  CHECK(report.actors.restarted == 0);
  CHECK(x.logged("kitchen/stove", "joined").size() == 1);
  CHECK(x.mote("stove").left_cause.empty());
  REQUIRE(report.proxies.size() == 2);
  CHECK(report.proxies[1].status == "active");
}

TEST_CASE("equal seeds give equal traces, other seeds others", "[actors][ecology][ACT-05]") {
  const auto trace = [](std::uint64_t seed) {
    ecology_fixture x(fault("1min", "crash", "mote = \"kitchen/stove\""), seed);
    x.end_at(2min);
    return std::pair(x.world.world().trace().hash(), x.world.world().trace().events());
  };
  const auto first = trace(1);
  CHECK(trace(1) == first);
  CHECK(trace(2).first != first.first);
}

namespace {

/// The state of an actor that the ecology_fixture knows.
template <class State, class Handle>
State& state_of(const caf::strong_actor_ptr& who) {
  using type = scheduler::shell<State, typename Handle::interface>;
  auto* found = dynamic_cast<type*>(who->get());
  REQUIRE(found != nullptr);
  return found->state;
}

std::size_t failures_among(const report::run_report& x) {
  return static_cast<std::size_t>(
      std::ranges::count(x.violations, report::no_actor_fails, &report::violation::invariant));
}

} // namespace

TEST_CASE("a planned crash excuses no other failure of that mote", "[actors][ecology][ACT-03]") {
  ecology_fixture x(
      fault("1min", "crash", "mote = \"kitchen/stove\"") +
      fault("60100ms", "crash", "mote = \"kitchen/stove\"")); // in vain: it is out of order
  x.world.run_for(2min);
  auto& state = state_of<ecology_state, root_actor>(x.root.strong());
  post_exit(state.motes.at({island_id{1}, mote_id{2}}).handle, caf::exit_reason::kill);
  const auto& report = x.end_at(5min);
  CHECK(report.actors.failures.size() == 1);
  CHECK(failures_among(report) == 1);
  CAPTURE(list_of(report.violations));
  REQUIRE(!report.violations.empty());
  CHECK(report.violations[0].at == instant(2min));
  CHECK(report.violations[0].detail.starts_with("mote/kitchen/stove: "));
}

TEST_CASE("failures are violations, however many crashes and failures there were before",
          "[actors][ecology][ACT-03]") {
  ecology_fixture x(R"(
[[fault]]
every = "2s"
kind = "crash"
mote = "kitchen/fan"
)");
  x.world.run_for(8min);
  auto& state = state_of<ecology_state, root_actor>(x.root.strong());
  CHECK(state.report.actors.failures.empty());
  for (int i = 0; i < 105; ++i) {
    x.world.run_for(2s);
    if (const auto& mote = state.motes.at({island_id{1}, mote_id{2}}); mote.handle)
      post_exit(mote.handle, caf::exit_reason::kill);
  }
  const auto& report = x.end_at(14min);
  CHECK(report.actors.failures.size() == 100); // no more are listed
  CHECK(failures_among(report) == 105);
}

TEST_CASE("a proxy that fails is a violation, though it is started again",
          "[actors][ecology][ACT-03]") {
  ecology_fixture x;
  x.world.run_for(1min);
  auto& state = state_of<ecology_state, root_actor>(x.root.strong());
  auto& manager =
      state_of<proxy_manager_state, proxy_manager_actor>(state.peers.at("pc").programs.at(0));
  REQUIRE(manager.proxies.size() == 2);
  post_exit(manager.proxies.begin()->second, caf::exit_reason::kill);
  const auto& report = x.end_at(5min);
  CHECK(manager.proxies.size() == 2);
  REQUIRE(failures_among(report) == 1);
  CHECK(report.violations[0].detail.starts_with("proxy of mote 1/2: "));
}

TEST_CASE("what cannot be had is a violation, and may end the run", "[actors][ecology][ACT-03]") {
  ecology_fixture x;
  x.world.send(x.root, request_unmet{"peis_peer/pc", "cannot listen"});
  const auto& report = x.end_at(2min);
  REQUIRE(report.violations.size() == 1);
  CHECK(report.violations[0].invariant == report::requests_are_met);
  CHECK(report.violations[0].detail == "peis_peer/pc: cannot listen");
  CHECK(x.logged("pc", "cannot listen").size() == 1);
}
