// A run that ends at the first flat battery does so in that moment, on any number of threads.
#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// Islands that share nothing, whose motes send at times and with batteries of their own; what
/// follows is about the last island, or are tables of the file.
std::string islands(int count, const std::string& mote = "battery = '0.7mAh'\n",
                    const std::string& rest = "") {
  std::string text = "[ecology]\nname = 'lives'\nduration = '10min'\nuntil = 'first_flat_battery'\n"
                     "[radio]\nrange = '15m'\nloss = '5%'\n[mote_type.m]\ntype = 1\n"
                     "transducers.temperature = { model = 'sine', mean = 20, amplitude = 5, "
                     "period = '1min' }\n"
                     "apps = [{ app = 'sampler', transducers = ['temperature'], every = '1s' }]\n";
  for (int i = 1; i <= count; ++i) {
    const auto x = std::to_string(i * 100);
    text += "[[island]]\nid = " + std::to_string(i) + "\nname = 'i" + std::to_string(i) +
            "'\nsink.position_m = [" + x +
            ", 0]\n[[island.group]]\ncount = 4\nfirst = 10\n"
            "type = 'm'\nlayout = 'ring'\ncentre = [" +
            x + ", 0]\nradius = '6m'\n" + mote;
  }
  return text + rest;
}

report::run_report run_of(config::ecology_description x, std::uint64_t seed, unsigned threads = 1) {
  run_options options;
  options.seed = seed;
  options.threads = threads;
  auto report = run_ecology(std::move(x), options);
  report.wall_s = 0;
  return report;
}

const report::mote_report& mote_of(const report::run_report& x, const std::string& name) {
  for (const auto& island : x.islands)
    for (const auto& mote : island.motes)
      if (island.name + '/' + mote.name == name)
        return mote;
  throw std::runtime_error("no mote " + name);
}

/// The moment and the mote are those of the first flat battery of a run that goes on, and all that
/// has happened is what happens until then.
void check_end(const config::ecology_description& what, std::uint64_t seed) {
  CAPTURE(what.name, seed);
  const auto x = run_of(what, seed);
  CHECK(x.complete);
  CHECK(!x.interrupted);
  CHECK(x.violations.empty());
  REQUIRE(!x.ended_by.empty());
  CHECK(x.simulated < what.length);
  CHECK(!mote_of(x, x.ended_by).alive);
  const auto flat = std::ranges::find(x.event_log, "battery flat", &report::logged_event::what);
  REQUIRE(flat != x.event_log.end());
  CHECK(flat->at.time_since_epoch() == x.simulated);
  CHECK(flat->who == x.ended_by);

  const auto expected = report::to_json(x);
  for (const unsigned threads : {2U, 3U}) {
    CAPTURE(threads);
    CHECK(report::to_json(run_of(what, seed, threads)) == expected);
  }
  auto shorter = what;
  shorter.until = config::run_end::duration;
  shorter.length = x.simulated;
  auto same = run_of(shorter, seed, 2);
  CHECK(same.ended_by.empty());
  same.ended_by = x.ended_by;
  CHECK(report::to_json(same) == expected);
}

} // namespace

TEST_CASE("a run ends with the first flat battery, in its very moment, on any number of threads",
          "[ecology][NRG-05][GEN-07][NFR-08]") {
  spdlog::set_level(spdlog::level::off);
  const auto what = describe(islands(5));
  std::set<duration> ends;
  std::set<std::string> motes;
  for (std::uint64_t seed = 1; seed <= seeds(6); ++seed) {
    check_end(what, seed);
    const auto x = run_of(what, seed);
    ends.insert(x.simulated);
    motes.insert(x.ended_by);
  }
  CHECK(ends.size() == seeds(6));
  CHECK(motes.size() > seeds(6) / 3); // not always the same island
}

TEST_CASE("motes that sleep live longer, and the first of them ends the run",
          "[ecology][NRG-05][GEN-07]") {
  spdlog::set_level(spdlog::level::off);
  auto text = islands(3, "battery = '0.3mAh'\n");
  text.replace(text.find("10min"), 5, "1h");
  for (auto at = text.find("sink.position_m"); at != std::string::npos;
       at = text.find("sink.position_m", at + 200))
    text.insert(at, "duty_cycle = { period = '4s', window = '100ms', settling = '20s' }\n");
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed)
    check_end(describe(text), seed);
}

TEST_CASE("a battery that the fault plan ends, ends the run a second later",
          "[ecology][NRG-05][ACT-04][GEN-07]") {
  spdlog::set_level(spdlog::level::off);
  for (const std::string victim : {"i2/m-11", "*"}) {
    const auto what = describe(
        islands(3, "battery = '2000mAh'\n",
                "[[fault]]\nkind = 'battery_end'\nat = '123.4567s'\nmote = '" + victim + "'\n"));
    for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
      check_end(what, seed);
      const auto x = run_of(what, seed);
      CHECK(x.simulated == 124'456'700us);
      CHECK((victim == "*" || x.ended_by == victim));
    }
  }
}

TEST_CASE("a mote takes its battery to another island", "[ecology][NRG-05][GEN-07]") {
  spdlog::set_level(spdlog::level::off);
  const auto what =
      describe(islands(3, "battery = '2000mAh'\n",
                       "[[island.mote]]\nid = 50\nname = 'guest'\ntype = 'm'\n"
                       "battery = '0.5mAh'\nposition_m = [303, 0]\n"
                       "[[fault]]\nkind = 'move'\nat = '40s'\n"
                       "mote = 'i3/guest'\nto_island = 'i1'\nto_m = [103, 0]\nfor = '5s'\n"));
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    check_end(what, seed);
    CHECK(run_of(what, seed).ended_by == "i1/guest");
  }
}

TEST_CASE("without a flat battery a run that may end with one has its duration",
          "[ecology][NRG-05]") {
  spdlog::set_level(spdlog::level::off);
  const auto what = describe(islands(2, "battery = '2000mAh'\n"));
  const auto x = run_of(what, 1, 2);
  CHECK(x.complete);
  CHECK(x.ended_by.empty());
  CHECK(x.simulated == what.length);
  auto without = what;
  without.until = config::run_end::duration;
  CHECK(report::to_json(run_of(without, 1)) == report::to_json(x));
}

TEST_CASE("who only watches a run changes nothing about its end", "[ecology][NRG-05]") {
  spdlog::set_level(spdlog::level::off);
  const auto what = describe(islands(2));
  const auto expected = report::to_json(run_of(what, 4));
  const auto file = std::filesystem::temp_directory_path() /
                    ("rubicon-lifetime-" + std::to_string(::getpid()) + ".rec");
  run_options watched;
  watched.seed = 4;
  watched.threads = 2;
  watched.record_file = file;
  std::size_t samples = 0;
  watched.look_every = 700ms;
  watched.on_sample = [&samples](const report::run_sample&) { ++samples; };
  watched.progress = [](const run_progress&) {};
  auto x = run_ecology(what, watched);
  x.wall_s = 0;
  CHECK(report::to_json(x) == expected);
  CHECK(samples == static_cast<std::size_t>(x.simulated / 700ms) + 1);
  std::filesystem::remove(file);
}

TEST_CASE("what a test does with time ends at the first flat battery, too",
          "[ecology][testkit][NRG-05]") {
  ecology x(islands(2, "battery = '2000mAh'\n"));
  x.run_for(100s);
  x.inject("kind = 'battery_end'\nmote = 'i1/m-12'\n");
  CHECK(!x.run_until([] { return false; }, 1h));
  CHECK(x.now() == instant(101s));
  x.run_for(10s);
  CHECK(x.now() == instant(101s));
}
