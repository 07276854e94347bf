#include <algorithm>
#include <string>

#include "actors/run/run.hpp"
#include "report/report.hpp"
#include "support/catch.hpp"
#include "testkit/ecology.hpp"

using namespace rubicon;
using test::ecology;

namespace {

constexpr const char* kitchen = R"(
[ecology]
name = "kitchen"
duration = "2min"

[mote_type.climate]
type = 1
transducers.temperature = { model = "points", points = [["0s", 21]] }
apps = [{ app = "sampler", transducers = ["temperature"], every = "2s" }]

[[island]]
name = "kitchen"
id = 1

[[island.mote]]
id = 2
name = "stove"
type = "climate"
position_m = [3, 0]

[[peer]]
name = "robot"
id = 100
)";

std::string with(std::string_view fault) {
  return std::string(kitchen) + "\n[[fault]]\n" + std::string(fault);
}

/// Why the action is refused.
template <class Action>
std::string refusal_of(Action action) {
  try {
    action();
  } catch (const test::bad_description& x) {
    return x.what();
  } catch (const test::failure& x) {
    return x.what();
  }
  return {};
}

bool holds(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool is_alive(const report::run_report& x, std::string_view peer) {
  const auto found = std::ranges::find(x.peers, peer, &report::peer_report::name);
  return found != x.peers.end() && found->alive;
}

} // namespace

TEST_CASE("an ecology runs as far as a test wants and tells what it has come to",
          "[testkit][ACT-02]") {
  ecology x{kitchen};
  CHECK(x.now() == instant{});
  REQUIRE(x.run_until([&] { return x.logged("kitchen/stove", "joined"); }, 10s));
  CHECK(x.now() < instant(10s));
  CHECK(!x.run_until([] { return false; }, 3s, 7ms));
  x.run_until(instant(30s));
  CHECK(x.now() == instant(30s));
  const auto report = x.report();
  CHECK(report.simulated == 30s);
  REQUIRE(report.islands.size() == 1);
  CHECK(report.islands[0].motes.at(0).joined);
  CHECK(report.islands[0].messages.arrived > 10);
  x.check_invariants();
  x.run_for(1min);
  CHECK(x.report().islands[0].messages.arrived > report.islands[0].messages.arrived + 20);
}

TEST_CASE("what is asked in between does not change a run", "[testkit][ACT-02]") {
  const auto file = std::string(RUBICON_CONFIG_DIR "/home.toml");
  auto asked = ecology::of_file(file);
  for (int i = 0; i < 11; ++i) {
    asked.run_for(1min);
    CHECK(asked.violations().empty());
  }
  auto x = asked.finish();
  auto y = ecology::of_file(file).finish();
  CHECK(x.trace_hash != y.trace_hash); // it holds the questions
  x.trace_hash = y.trace_hash;
  x.events = y.events;
  x.wall_s = y.wall_s;
  CHECK(report::to_json(x) == report::to_json(y));
}

TEST_CASE("an ecology that is run to its end is the run that a command makes",
          "[testkit][ACT-02]") {
  auto by_steps = ecology::of_file(RUBICON_CONFIG_DIR "/home.toml", {.seed = 7});
  by_steps.run_for(100s);
  const auto x = by_steps.finish();
  run_options options;
  options.seed = 7;
  const auto loaded = config::load_file(RUBICON_CONFIG_DIR "/home.toml");
  const auto y = run_ecology(loaded.ecology.value(), options);
  CHECK(x.trace_hash == y.trace_hash);
  CHECK(x.complete);
  CHECK(x.seed == 7);
}

TEST_CASE("a fault that is given in the course of a run is the same as one in the file",
          "[testkit][ACT-02][ACT-04]") {
  const auto* const words = GENERATE("kind = 'kill'\npeer = 'robot'\nfor = '20s'",
                                     "kind = 'crash'\nmote = 'kitchen/stove'\nfor = '5s'",
                                     "kind = 'unplug'\nisland = 'kitchen'\nfor = '10s'",
                                     "kind = 'radio_loss'\nloss = 0.5\nfor = '10s'",
                                     "kind = 'battery_end'\nmote = 'kitchen/stove'");
  ecology planned{with(std::string("at = '30123457us'\n") + words)};
  ecology given{kitchen};
  given.run_for(30s);
  given.inject(std::string("at = '30123457us'\n") + words);
  ecology calm{kitchen};
  const auto x = planned.finish();
  CHECK(given.finish().trace_hash == x.trace_hash);
  CHECK(calm.finish().trace_hash != x.trace_hash);
}

TEST_CASE("a fault without a time happens now, and one before the run is as in the file",
          "[testkit][ACT-02][ACT-04]") {
  ecology x{kitchen};
  x.inject("at = '50s'\nkind = 'noise'\nisland = 'kitchen'\nposition_m = [1, 1]\nfor = '1s'");
  x.run_for(20s);
  CHECK(is_alive(x.report(), "robot"));
  x.inject("kind = 'kill'\npeer = 'robot'\nfor = '20s'");
  x.run_for(0s);
  CHECK(!is_alive(x.report(), "robot"));
  CHECK(x.tuple("robot", "kernel.id") == std::nullopt);
  x.run_for(21s);
  CHECK(is_alive(x.report(), "robot"));
  x.run_for(20s);
  CHECK(x.logged("kitchen", "noise"));
}

TEST_CASE("tuples are read at a peer by their key", "[testkit][ACT-02]") {
  ecology x{kitchen};
  x.run_for(20s);
  CHECK(x.tuple("kitchen-gateway", "devices.2.output.1").has_value());
  CHECK(x.tuple("robot", "kernel.id") == "100");
  CHECK(x.tuple("robot", "no.such.key") == std::nullopt);
  CHECK_THROWS_AS(x.tuple("nobody", "kernel.id"), test::failure);
}

TEST_CASE("a text with mistakes is refused with their places", "[testkit][ACT-02]") {
  CHECK(refusal_of([] { ecology{"[ecology]\nname = 3\n"}; }) ==
        "ecology:1:1: the file has neither an [[island]] nor a [[peer]]\n"
        "ecology:2:8: `name` must be a name of 1 to 32 letters, digits, - and _, not 3\n"
        "ecology: 2 problems\n");
  CHECK(refusal_of([] { static_cast<void>(ecology::of_file("/no/such.toml")); }) ==
        "/no/such.toml: cannot be opened: No such file or directory\n");
  ecology x{kitchen};
  x.run_for(40s);
  const auto misspelt = refusal_of([&] { x.inject("kind = 'kill'\npeer = 'robott'"); });
  CHECK(misspelt.starts_with("fault:2:8: "));
  CHECK(holds(misspelt, "robott"));
  CHECK(holds(refusal_of([&] { x.inject("at = '30s'\nkind = 'kill'\npeer = 'robot'"); }), "past"));
  CHECK(holds(refusal_of([&] {
                x.inject("kind = 'noise'\nisland = 'kitchen'\nposition_m = [1, 1]\nfor = '1s'");
              }),
              "a radio that is not there"));
  x.run_for(1s); // as if nothing had been said
  x.check_invariants();
}

TEST_CASE("violated invariants are told", "[testkit][ACT-02]") {
  ecology x{with("at = '5s'\nkind = 'kill'\npeer = 'robot'")};
  x.check_invariants();
  config::ecology_description nothing;
  nothing.name = "nothing";
  ecology y{nothing};
  y.run_for(1s);
  CHECK(holds(refusal_of([&] { y.check_invariants(); }), "nothing ran"));
}
