// Islands and PCs on several threads, and ahead of each other: what comes out is the same.
#include <filesystem>

#include <unistd.h>

#include "ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

std::string outcome(const config::ecology_description& x, std::uint64_t seed,
                    const run_options& how) {
  auto options = how;
  options.seed = seed;
  auto report = run_ecology(x, options);
  report.wall_s = 0;
  return report::to_json(report); // with the hash of its trace
}

run_options on_threads(unsigned count) {
  run_options x;
  x.threads = count;
  return x;
}

void compare(config::ecology_description x, duration length, std::uint64_t seeds) {
  CAPTURE(x.name);
  x.length = std::min(x.length, length);
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    CAPTURE(seed);
    const auto expected = outcome(x, seed, {});
    for (const unsigned threads : {2U, 3U, 8U}) {
      CAPTURE(threads);
      CHECK(outcome(x, seed, on_threads(threads)) == expected);
    }
    // In steps, as with a progress bar.
    run_options in_steps;
    in_steps.progress = [](const run_progress&) {};
    CHECK(outcome(x, seed, in_steps) == expected);
  }
}

} // namespace

TEST_CASE("the shipped ecologies come out the same on any number of threads",
          "[ecology][GEN-07][NFR-08]") {
  for (const auto* file : {"home.toml", "daily.toml", "learning.toml", "operators.toml"})
    compare(example(file), 10min, 3);
  compare(example("stream-line.toml"), 5min, 1);
  compare(example("intel-lab.toml"), 10min, 1);
}

TEST_CASE("every shipped ecology comes out the same with twenty seeds", "[.][seeds][GEN-07]") {
  for (const auto& file : std::filesystem::recursive_directory_iterator(RUBICON_CONFIG_DIR)) {
    const auto& path = file.path();
    if (path.extension() == ".toml" && path.stem() != "tossim-grid") // which wants TOSSIM's files
      compare(describe_file(path.string()), 10min, 20);
  }
}

TEST_CASE("whoever watches a run sees one event after the other, and changes nothing",
          "[ecology][GEN-07][NFR-08]") {
  auto home = example("home.toml");
  home.length = 6min;
  const auto expected = outcome(home, 1, on_threads(2));
  auto watched = on_threads(2);
  const auto file = std::filesystem::temp_directory_path() /
                    ("rubicon-threads-" + std::to_string(::getpid()) + ".rec");
  watched.record_file = file;
  CHECK(outcome(home, 1, watched) == expected);
  std::filesystem::remove(file);
}

TEST_CASE("faults in the middle of islands on threads change nothing", "[ecology][NFR-08]") {
  const std::string many = [] {
    std::string text =
        "[ecology]\nname = 'many'\nduration = '5min'\n[radio]\nrange = '15m'\n"
        "loss = '5%'\n[mote_type.m]\ntype = 1\n"
        "transducers.temperature = { model = 'sine', mean = 20, amplitude = 5, "
        "period = '1min' }\n"
        "apps = [{ app = 'sampler', transducers = ['temperature'], every = '3s' }]\n";
    for (int i = 1; i <= 8; ++i)
      text += "[[island]]\nid = " + std::to_string(i) + "\nname = 'i" + std::to_string(i) +
              "'\nsink.position_m = [" + std::to_string(i * 100) +
              ", 0]\n[[island.group]]\ncount = 10\nfirst = 10\ntype = 'm'\nlayout = 'ring'\n"
              "centre = [" +
              std::to_string(i * 100) + ", 0]\nradius = '6m'\n";
    for (const auto* what : {"'crash'\nmote = '*'", "'crash'\nsink = '*'", "'unplug'\nisland = '*'",
                             "'kill'\npeer = '*'", "'pause'\npeer = '*'"})
      text += "[[fault]]\nrandom = 4\nfrom = '30s'\nuntil = '4min'\nfor = '7s'\nkind = " +
              std::string(what) + '\n';
    return text;
  }();
  compare(describe(many), 5min, 2);
}
