// What is another way from some moment of a run on (ACT-10), and what follows from it.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// Two thermometers near their sink, and a PC with their proxies.
constexpr std::string_view flat = R"(
  ecology = { name = "flat", duration = "10min" }
  [radio]
  range = "15m"
  [mote_type.climate]
  type = 100
  transducers.temperature = { model = "constant", value = 20, resolution = 0.1 }
  apps = [{ app = "sampler", transducers = ["temperature"], every = "10s" }]
  [[island]]
  id = 1
  name = "flat"
  mote = [
    { id = 2, name = "stove", type = "climate", position_m = [5, 0] },
    { id = 3, name = "window", type = "climate", position_m = [0, 5] },
  ]
  [[peer]]
  id = 40
  name = "pc"
  apps = [{ app = "proxy_manager" }]
  [[proxy]]
  name = "climate"
  types = [100]
  field = [{ name = "temperature", channel = 1, scale = 0.1, decimals = 1, unit = "C" }]
)";

/// A run, and what was set in it.
struct told_run {
  report::run_report report;
  std::vector<report::tuple_write> writes;

  /// How often the tuple was set from `from` up to `until`.
  [[nodiscard]] std::ptrdiff_t count(std::string_view key, duration from, duration until) const {
    return std::ranges::count_if(writes, [&](const auto& x) {
      return x.key == key && !x.deleted && x.at >= instant(from) && x.at < instant(until);
    });
  }
  /// Its values, each once, in order.
  [[nodiscard]] std::vector<std::string> values(std::string_view key) const {
    std::vector<std::string> all;
    for (const auto& x : writes)
      if (x.key == key && (all.empty() || all.back() != x.value))
        all.push_back(x.value);
    return all;
  }
  [[nodiscard]] bool has_logged(std::string_view who, std::string_view what) const {
    return std::ranges::any_of(report.event_log,
                               [&](const auto& x) { return x.who == who && x.what == what; });
  }
};

told_run run_with(std::string_view tables, unsigned threads = 1) {
  told_run x;
  run_options options;
  options.threads = threads;
  options.on_tuple = [&x](const report::tuple_write& each) { x.writes.push_back(each); };
  x.report = run_ecology(describe(std::string(flat).append(tables)), options);
  for (const auto& violation : x.report.violations)
    FAIL_CHECK(violation.invariant << ": " << violation.detail);
  return x;
}

constexpr std::string_view rate = R"(
  [[change]]
  at = "4min"
  kind = "rate"
  mote = "flat/stove"
  period = "2s"
)";

} // namespace

TEST_CASE("a mote reports at another rate, also after it was started again", "[ecology][ACT-10]") {
  const auto x = run_with(std::string(rate) + R"(
    [[fault]]
    at = "7min"
    kind = "crash"
    mote = "flat/stove"
  )");
  CHECK(x.has_logged("flat/stove", "sampler 1: every 2 s instead of 10 s"));
  CHECK(x.count("devices.2.output.1", 1min, 4min) == 18);
  CHECK(x.count("devices.2.output.1", 245s, 6min + 45s) == Approx(80).margin(1));
  CHECK(x.count("devices.2.output.1", 8min, 10min) == Approx(60).margin(2));
  CHECK(x.count("devices.3.output.1", 245s, 10min) == Approx(35).margin(1));
}

TEST_CASE("a mote that is off when its rate changes has it when it is back", "[ecology][ACT-10]") {
  const auto x = run_with(R"(
    [[fault]]
    at = "3min"
    kind = "crash"
    mote = "flat/stove"
    for = "2min"
    [[change]]
    at = "4min"
    kind = "rate"
    mote = "flat/stove"
    sampler = 1
    period = "2s"
  )");
  CHECK(x.count("devices.2.output.1", 3min + 1s, 5min) == 0);
  CHECK(x.count("devices.2.output.1", 6min, 10min) == Approx(120).margin(2));
}

TEST_CASE("a mote that is carried to another island keeps its rate", "[ecology][ACT-10]") {
  const auto x = run_with(std::string(rate) + R"(
    [[island]]
    id = 2
    name = "shed"
    sink.position_m = [200, 0]
    [[fault]]
    at = "6min"
    kind = "move"
    mote = "flat/stove"
    to_island = "shed"
    to_m = [205, 0]
    [[change]]
    at = "8min"
    kind = "rate"
    mote = "flat/stove"
    period = "1s"
  )");
  CHECK(x.count("devices.2.output.1", 7min, 8min) == Approx(30).margin(1));
  CHECK(x.has_logged("shed/stove", "sampler 1: every 1 s instead of 2 s"));
  CHECK(x.count("devices.2.output.1", 8min + 2s, 10min) == Approx(118).margin(2));
}

TEST_CASE("a mote of another type has no such program any more", "[ecology][ACT-10]") {
  const auto x = run_with(R"(
    [mote_type.door]
    type = 300
    [[fault]]
    at = "3min"
    kind = "crash"
    mote = "flat/stove"
    type = "door"
    [[change]]
    at = "4min"
    kind = "rate"
    mote = "flat/stove"
    period = "2s"
  )");
  CHECK(x.has_logged("flat/stove", "has no sampler 1 now, which could change"));
  CHECK(x.report.actors.changes_refused == 1);
}

TEST_CASE("a link is another from some moment on, and once more", "[ecology][ACT-10]") {
  const auto link = [](const char* at, const char* to, const std::string& how) {
    return std::string("[[change]]\nat = \"") + at + "\"\nkind = \"link\"\n" +
           "from = \"flat/stove\"\nto = \"flat/" + to + "\"\n" + how + '\n';
  };
  const auto cut = [&link](const std::string& how, const std::string& again) {
    return run_with(link("4min", "sink", how) + link("4min", "window", how) +
                    link("6min", "sink", again));
  };
  const auto lost = cut("loss = 1", "loss = 0");
  CHECK(lost.has_logged("flat/stove", "link to flat/sink: loss 100 %"));
  CHECK(lost.count("devices.2.output.1", 1min, 4min) == 18);
  CHECK(lost.count("devices.2.output.1", 4min + 1s, 6min) == 0);
  CHECK(lost.count("devices.2.output.1", 7min, 10min) >= 15);
  CHECK(lost.count("devices.3.output.1", 4min, 10min) >= 34); // others' links are as they were
  const auto weak = cut("gain = \"-150dB\"", "gain = \"-60dB\"");
  CHECK(weak.count("devices.2.output.1", 1min, 4min) == 18);
  CHECK(weak.count("devices.2.output.1", 4min + 1s, 6min) == 0);
  CHECK(weak.count("devices.2.output.1", 7min, 10min) >= 15);
}

TEST_CASE("proxies go by their class as it is now, and so do new ones", "[ecology][ACT-10]") {
  const auto x = run_with(R"(
    [[change]]
    at = "4min"
    kind = "proxy_class"
    class = "climate"
    period = "5s"
    field = "temperature"
    unit = "K"
    add = 273.15
    decimals = 2
    [[fault]]
    at = "7min"
    kind = "kill"
    peer = "pc"
    for = "2s"
  )");
  CHECK(x.has_logged("flat", "proxy class climate: period 5 s, add of temperature 273.15, "
                             "decimals of temperature 2, unit of temperature K"));
  CHECK(x.values("flat.stove.temperature") == std::vector<std::string>{"20.0", "293.15"});
  CHECK(x.values("flat.window.temperature.unit") == std::vector<std::string>{"C", "K"});
  CHECK(x.count("flat.stove.temperature", 1min, 4min) == 18);
  CHECK(x.count("flat.stove.temperature", 250s, 6min + 50s) == Approx(32).margin(2));
  CHECK(x.count("flat.stove.temperature", 8min, 10min) == Approx(24).margin(2));
}

TEST_CASE("changes are the same on one thread and on three", "[ecology][ACT-10][GEN-07]") {
  const auto all = std::string(rate) + R"(
    [[change]]
    at = "3min"
    kind = "link"
    from = "flat/window"
    to = "flat/sink"
    loss = "40%"
    [[change]]
    at = "5min"
    kind = "proxy_class"
    class = "climate"
    stale_after = "15s"
    [[change]]
    at = "6min"
    kind = "debug"
    of = ["mote/flat"]
  )";
  const auto one = run_with(all);
  const auto three = run_with(all, 3);
  CHECK(one.report.trace_hash == three.report.trace_hash);
  CHECK(one.report.trace_hash != run_with(rate).report.trace_hash);
  CHECK(one.has_logged("flat", "debug log of mote/flat, but --debug-dir does not say where"));
}

TEST_CASE("a change that is asked for while the run is on", "[ecology][ACT-10][ACT-02]") {
  ecology x(flat);
  x.run_for(2min);
  x.change("kind = 'rate'\nmote = 'flat/stove'\nperiod = '1s'");
  x.run_for(5s);
  CHECK(x.logged("flat/stove", "sampler 1: every 1 s instead of 10 s"));
  CHECK_THROWS_AS(x.change("kind = 'tick'"), bad_description);
}
