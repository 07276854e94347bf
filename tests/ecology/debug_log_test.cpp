#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "actors/run/ecology_run.hpp"
#include "ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// A folder of its own that ends with the test.
struct scratch_folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() /
      ("rubicon-debug-test-" + std::to_string(getpid()) + '-' + std::to_string(++folders));
  static inline int folders = 0;
  ~scratch_folder() { std::filesystem::remove_all(path); }
};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Two motes, and a PC.
constexpr std::string_view flat = R"(
  ecology = { name = "flat", duration = "6min" }
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
)";

/// A debug folder of its own, what has been written into it, and the run.
struct debugged_run {
  explicit debugged_run(std::string_view tables, std::vector<std::string> of = {"*"})
      : description(describe(std::string(flat).append(tables))) {
    spdlog::set_level(spdlog::level::err);
    options.debug_folder = folder.path.string();
    options.debug_of = std::move(of);
  }
  /// Sets the tuple of the PC at these times.
  report::run_report run(const std::vector<std::pair<duration, std::string>>& switches) {
    std::optional<run_control> control;
    options.on_begun = [&control](const run_control& x) { control.emplace(x); };
    ecology_run all(description, options);
    for (const auto& [at, text] : switches) {
      static_cast<void>(all.world().run_until(instant(at)));
      CHECK(control->set_tuple("pc", "rubicon.debug", text));
    }
    return all.finish();
  }
  [[nodiscard]] std::string log(const std::string& module) const {
    return text_of(folder.path / (module + ".log"));
  }
  /// Seconds of the lines about an actor: the first and the last.
  [[nodiscard]] std::pair<double, double> times_of(const std::string& path) const {
    std::istringstream lines(log(path.substr(0, path.find('/'))));
    std::pair<double, double> found{-1, -1};
    for (std::string line; std::getline(lines, line);) {
      const auto space = line.find(' ');
      if (line.compare(space + 1, path.size() + 1, path + ' ') != 0)
        continue;
      found.second = std::stod(line.substr(0, space));
      if (found.first < 0)
        found.first = found.second;
    }
    return found;
  }

  scratch_folder folder;
  config::ecology_description description;
  run_options options;
};

} // namespace

TEST_CASE("debug mode writes each module's messages, sent and received", "[ecology][NFR-01]") {
  const scratch_folder folder;
  spdlog::set_level(spdlog::level::err);
  auto home = example("home.toml");
  home.length = 20s;
  run_options options;
  options.debug_folder = folder.path.string();
  const auto with = run_ecology(home, options);
  for (const auto* module : {"air", "mote", "sink", "serial_line", "gateway", "peis_peer", "proxy",
                             "proxy_manager", "mote_app"}) {
    const auto lines = text_of(folder.path / (std::string(module) + ".log"));
    CHECK_FALSE(lines.empty());
    CHECK(lines.find("<unprintable>") == std::string::npos);
  }
  const auto motes = text_of(folder.path / "mote.log");
  CHECK(motes.find("mote/kitchen/fan received from=air/kitchen length=") != std::string::npos);
  CHECK(motes.find("mote/kitchen/fan sent to=air/kitchen length=") != std::string::npos);

  // Watching changes nothing, and without it no file is written.
  std::filesystem::remove_all(folder.path);
  const auto without = run_ecology(home, {});
  CHECK(with.trace_hash == without.trace_hash);
  CHECK_FALSE(std::filesystem::exists(folder.path));
}

TEST_CASE("debug logs are rotated and stay within their limit", "[ecology][NFR-03]") {
  const scratch_folder folder;
  spdlog::set_level(spdlog::level::err);
  run_options options;
  options.debug_folder = folder.path.string();
  options.debug_file_octets_max = 100'000;
  static_cast<void>(run_ecology(example("home.toml"), options));
  std::map<std::string, std::uintmax_t> octets;
  for (const auto& file : std::filesystem::directory_iterator(folder.path)) {
    const auto name = file.path().filename().string();
    octets[name.substr(0, name.find('.'))] += file.file_size();
  }
  CHECK(std::filesystem::exists(folder.path / "peis_peer.2.log")); // there was more than fits
  for (const auto& [module, size] : octets)
    CHECK(size <= 3 * 100'000);
}

TEST_CASE("a debug folder that cannot be made is an error", "[ecology][NFR-01]") {
  run_options options;
  options.debug_folder = "/proc/rubicon";
  CHECK_THROWS_AS(run_ecology(example("home.toml"), options), std::runtime_error);
}

TEST_CASE("debug logs are of some modules and actors only", "[ecology][NFR-02]") {
  debugged_run x("", {"mote/flat/stove", "gateway"});
  const auto report = x.run({});
  CHECK(x.times_of("mote/flat/stove").first >= 0);
  CHECK(x.times_of("mote/flat/window").first < 0);
  CHECK_FALSE(x.log("gateway").empty());
  for (const auto* module : {"air", "sink", "serial_line", "peis_peer", "mote_app"})
    CHECK(x.log(module).empty());
  CHECK(report.trace_hash == run_ecology(x.description, {}).trace_hash);
}

TEST_CASE("a tuple switches one mote's debug log while the run is on", "[ecology][NFR-02]") {
  const std::string_view crash = R"(
    [[fault]]
    at = "3min"
    kind = "crash"
    mote = "flat/stove"
  )";
  debugged_run x(crash, {});
  const auto report = x.run({{2min, "mote/flat/stove"}, {5min, ""}});
  CHECK(report.violations.empty());
  const auto [first, last] = x.times_of("mote/flat/stove");
  CHECK(first >= 120);
  CHECK(first < 131);
  CHECK(last > 285); // its second life is written down as well
  CHECK(last <= 300);
  CHECK(x.times_of("mote/flat/window").first < 0);
  CHECK(x.log("mote").find("crash_now") != std::string::npos);
  CHECK(x.log("gateway").empty());
  CHECK(has_logged(report, "pc", "debug log of mote/flat/stove"));
  CHECK(has_logged(report, "pc", "debug log of no actors"));
  CHECK(report.actors.changes_refused == 0);

  const auto log = x.log("mote");
  debugged_run again(crash, {});
  CHECK(again.run({{2min, "mote/flat/stove"}, {5min, ""}}).trace_hash == report.trace_hash);
  CHECK(again.log("mote") == log);

  debugged_run without(crash, {});
  without.options.debug_folder.clear();
  const auto untold = without.run({{2min, "mote/flat/stove"}, {5min, ""}});
  CHECK(untold.trace_hash == report.trace_hash);
  CHECK(
      has_logged(untold, "pc", "debug log of mote/flat/stove, but --debug-dir does not say where"));
}

TEST_CASE("a pattern of nobody changes no debug log", "[ecology][NFR-02]") {
  debugged_run x("", {"mote/flat/window"});
  const auto report = x.run({{2min, "mote/flat/stowe"}, {3min, "mote mots"}});
  CHECK(x.times_of("mote/flat/window").second > 340);
  CHECK(x.times_of("mote/flat/stove").first < 0);
  CHECK(report.actors.changes_refused == 2);
  CHECK(has_logged(report, "pc",
                   "debug log stays as it is: no actor is named `mote/flat/stowe`: did you mean "
                   "`mote/flat/stove`?"));
  CHECK(has_logged(report, "pc",
                   "debug log stays as it is: there is no module `mots`: did you mean `mote`?"));
}

TEST_CASE("who floods a peer with wishes for its debug log is not followed for long",
          "[ecology][NFR-02]") {
  debugged_run x("", {});
  std::vector<std::pair<duration, std::string>> flood;
  for (int i = 0; i < 100; ++i)
    flood.emplace_back(1min + i * 1ms, "mots");
  flood.emplace_back(80s, "mote/flat/stove"); // later he is again
  const auto report = x.run(flood);
  CHECK(report.actors.changes_refused == 20);
  CHECK(x.times_of("mote/flat/stove").first >= 80);
}

TEST_CASE("a planned change switches the debug log", "[ecology][NFR-02][ACT-10]") {
  debugged_run x(R"(
    [[change]]
    at = "1min"
    kind = "debug"
    of = ["mote/flat/window"]
    [[change]]
    at = "2min"
    kind = "debug"
    of = ["sink/flat", "mote/flat/stove"]
  )",
                 {});
  const auto report = x.run({});
  const auto [first, last] = x.times_of("mote/flat/window");
  CHECK(first >= 60);
  CHECK(last <= 120);
  CHECK(x.times_of("mote/flat/stove").first >= 120);
  CHECK(x.times_of("sink/flat").first >= 120);
  CHECK(has_logged(report, "flat", "debug log of sink/flat, mote/flat/stove"));
}
