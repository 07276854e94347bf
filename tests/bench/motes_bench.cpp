// What a mote costs: whole ecologies of motes that join their islands and send a reading a minute,
// from the program's actors down to the medium, in virtual time.
//
// All sizes have the same density: islands of 100 motes in a grid of 10 m with a range of 15 m, the
// sink in the middle, so that most readings go over several hops. Islands stand too far apart to
// hear each other; all are in one air, and their gateways in one PEIS network.
//
// A calibration loop in the same run makes figures of different machines comparable: steps are its.
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <malloc.h>
#include <spdlog/spdlog.h>

#include "actors/run/run.hpp"
#include "calibration.hpp"
#include "figures.hpp"
#include "io/process/spare_memory.hpp"
#include "mote_islands.hpp"

namespace {

using namespace rubicon;
using bench::at_least;
using bench::at_most;

constexpr unsigned island_motes = 100;
/// Everybody has joined, beacons are rare. A run stops for its progress where its steps end, which
/// double while they take little time: small ecologies stop at these two moments too.
constexpr duration settled_after = 131'071ms;
constexpr duration measured = 131'072ms;

double resident() {
  return static_cast<double>(io::resident_memory());
}

struct cost {
  double cpu_s = 0;   ///< of a simulated minute
  double wall_s = 0;  ///< the same
  double octets = 0;  ///< resident, of one mote
  double events = 0;  ///< between actors, of a mote in the whole run
  double joined = 0;  ///< share of the motes
  double arrived = 0; ///< share of the readings sent
};

cost measure(unsigned motes) {
  ::malloc_trim(0);
  const auto before = resident();
  auto what = bench::mote_islands(motes / island_motes, island_motes, true);
  what.length = settled_after + measured;
  cost x;
  struct start {
    double cpu_s;
    double wall_s;
    instant reached;
  };
  std::optional<start> started;
  run_options options;
  options.progress = [&](const run_progress& p) {
    if (!started && p.reached >= instant(settled_after))
      started = {bench::cpu_s(), bench::wall_s(), p.reached};
    if (p.reached < p.end)
      return;
    const auto minutes = seconds(p.end - started->reached) / 60;
    x.cpu_s = (bench::cpu_s() - started->cpu_s) / minutes;
    x.wall_s = (bench::wall_s() - started->wall_s) / minutes;
    x.octets = (resident() - before) / motes;
  };
  const auto report = run_ecology(std::move(what), options);
  const auto messages = report.messages();
  x.events = static_cast<double>(report.events) / motes;
  x.joined = static_cast<double>(report.motes_joined()) / motes;
  x.arrived =
      static_cast<double>(messages.received) / static_cast<double>(messages.unreliable_sent);
  return x;
}

} // namespace

int main(int argc, char** argv) {
  bool json = false;
  std::vector<unsigned> sizes{100, 1000, 10'000};
  CLI::App command{"What a mote costs in ecologies of several sizes"};
  command.add_flag("--json", json, "figures as JSON");
  command.add_option("--motes", sizes, "sizes to measure, whole islands of 100 motes")
      ->check(CLI::Range(100U, 25'000U));
  CLI11_PARSE(command, argc, argv);
  spdlog::set_level(spdlog::level::err);
  bench::figures out;
  std::vector<double> each; // steps a mote and minute
  for (const unsigned motes : sizes) {
    out.section(std::to_string(motes) + " motes", "joined, a reading a minute each");
    const auto calibration = bench::calibrate() * 1e6;
    const auto x = measure(motes);
    each.push_back(x.cpu_s / motes * calibration);
    out.add("wall time, a simulated minute", x.wall_s, 3, "s");
    out.add("processor time, the same", x.cpu_s, 3, "s");
    out.add("the same, a mote", x.cpu_s / motes * 1e6, 0, "us");
    out.add("the same in calibration steps", each.back() / 1e3, 0, "k steps");
    out.add("against the first size", each.back() / each.front(), 2, "", at_most(1.5));
    out.add("resident memory, a mote", x.octets / 1024, 1, "KiB");
    out.add("messages between actors, a mote", x.events, 0, "");
    out.add("motes joined", 100 * x.joined, 1, "%", at_least(100));
    out.add("readings arrived", 100 * x.arrived, 1, "%", at_least(99));
  }
  if (json)
    out.print_json();
  return out.failures() == 0 ? 0 : 1;
}
