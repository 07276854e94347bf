// Runs that break off, and files that cannot be written: neither is a good end (ACT-03).
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <string>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

namespace fs = std::filesystem;

config::ecology_description short_home() {
  auto home = example("home.toml");
  home.length = 10s;
  return home;
}

report::run_report run_with(const config::ecology_description& what, const run_options& options) {
  spdlog::set_level(spdlog::level::off); // errors are what is wanted here
  return run_ecology(what, options);
}

void check_violation(const report::run_report& x, std::string_view invariant,
                     std::string_view detail) {
  CAPTURE(told_violations(x));
  CHECK(std::ranges::any_of(x.violations, [&](const report::violation& each) {
    return each.invariant == invariant && each.detail.find(detail) != std::string::npos;
  }));
}

} // namespace

TEST_CASE("a good run is complete", "[ecology][ACT-03]") {
  const auto x = run_with(short_home(), {});
  CHECK(x.complete);
  CHECK(x.reason.empty());
  CHECK(told_violations(x).empty());
}

TEST_CASE("a run whose supervisor fails at birth is not complete", "[ecology][ACT-03]") {
  auto home = short_home();
  home.peers.front().links = {"nobody"}; // no file can say so
  const auto x = run_with(home, {});
  CHECK_FALSE(x.complete);
  CHECK(x.reason.starts_with("the supervisor of the ecology ended: "));
  CHECK(x.ecology == home.name);
  CHECK(x.simulated < home.length);
  check_violation(x, "the run is complete", x.reason);
}

TEST_CASE("a run whose supervisor fails on its way ends at once, and says so",
          "[ecology][ACT-03]") {
  auto home = short_home();
  home.faults = {{5s, config::crash_fault{{island_id{77}, mote_id{7}}}}}; // there is none
  const auto x = run_with(home, {});
  CHECK_FALSE(x.complete);
  CHECK_FALSE(x.interrupted);
  CHECK(x.simulated == 5s);
  check_violation(x, "the run is complete", "the supervisor of the ecology ended: ");
  CHECK(to_json(x).find(R"("complete": false)") != std::string::npos);
}

TEST_CASE("an exception in the middle of a run does not make it complete", "[ecology][ACT-03]") {
  run_options options;
  options.progress = [](const run_progress& x) {
    if (x.reached >= instant(5s))
      throw std::bad_alloc();
  };
  const auto x = run_with(short_home(), options);
  CHECK_FALSE(x.complete);
  check_violation(x, "the run is complete", "out of memory");
}

TEST_CASE("a planned crash is no violation", "[ecology][ACT-03]") {
  auto home = short_home();
  home.length = 5min;
  home.faults = {{1min, config::crash_fault{{island_id{1}, mote_id{2}}}}};
  const auto x = run_with(home, {});
  CHECK(told_violations(x).empty());
  CHECK(x.actors.failures.empty());
}

TEST_CASE("records, captures and debug logs that are cut short are told", "[ecology][ACT-07]") {
  const test::scratch_folder folder;
  const auto full = [&](const std::string& name) {
    fs::create_symlink("/dev/full", folder.path / name);
  };
  run_options options;
  SECTION("the record") {
    options.record_file = "/dev/full";
    const auto x = run_with(short_home(), options);
    CHECK(x.complete); // it is the file that is not
    check_violation(x, "what was asked for is there", "record /dev/full is not complete: No space");
  }
  SECTION("a capture") {
    full("island-1.pcap");
    options.pcap_folder = folder.path.string();
    check_violation(run_with(short_home(), options), "what was asked for is there",
                    "island-1.pcap: No space");
  }
  SECTION("a debug log") {
    full("mote.log");
    options.debug_folder = folder.path.string();
    check_violation(run_with(short_home(), options), "what was asked for is there",
                    "debug logs in ");
  }
  SECTION("a debug log that cannot be opened") {
    fs::create_directory(folder.path / "gateway.log");
    options.debug_folder = folder.path.string();
    const auto x = run_with(short_home(), options);
    CHECK(x.actors.failures.empty()); // no actor has done wrong
    check_violation(x, "what was asked for is there", "debug logs in ");
  }
}

TEST_CASE("a record that may end does so, and nobody minds", "[ecology]") {
  const test::scratch_folder folder;
  run_options options;
  options.record_octets_max = 50'000;
  SECTION("before it is too long") {
    options.record_file = folder.file("run.rec");
    CHECK(told_violations(run_with(short_home(), options)).empty());
    std::ifstream file(options.record_file);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    CHECK(text.size() <= 50'000);
    CHECK(text.size() > 40'000);
    CHECK(text.ends_with("}\n")); // its lines are whole
  }
  SECTION("or where there is no room for it") {
    options.record_file = "/dev/full";
    CHECK(told_violations(run_with(short_home(), options)).empty());
  }
}

TEST_CASE("a program's file that cannot be written is a violation", "[ecology]") {
  auto room = example("operators.toml");
  room.length = 2min;
  std::get<apps::recorder_config>(room.islands.at(0).gateway_apps.at(0)).file = "/dev/full";
  check_violation(run_with(room, {}), "what was asked for is there", "cannot write /dev/full");
}
