// What the account of messages costs: whole ecologies with it and without it, in turn, in this
// process.
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <malloc.h>
#include <spdlog/spdlog.h>

#include "actors/run/run.hpp"
#include "calibration.hpp"
#include "config/load.hpp"
#include "core/account/message_ledger.hpp"
#include "figures.hpp"
#include "io/process/spare_memory.hpp"
#include "mote_islands.hpp"

namespace {

using namespace rubicon;

struct cost {
  double cpu_s = 1e9;   ///< least of all runs
  double octets = 1e18; ///< resident at the end, what was before it apart; least of all runs
  std::string hash;
};

config::ecology_description file(const std::string& name, duration length) {
  auto loaded = config::load_file(RUBICON_CONFIG_DIR "/" + name);
  if (!loaded.ecology)
    throw std::runtime_error(name + " cannot be read");
  loaded.ecology->length = length;
  return *std::move(loaded.ecology);
}

void measure(const config::ecology_description& what, bool accounts, cost& x) {
  ::malloc_trim(0);
  const auto before = static_cast<double>(io::resident_memory());
  double after = before;
  run_options options;
  options.progress = [&](const run_progress& p) {
    if (p.reached >= p.end)
      after = static_cast<double>(io::resident_memory());
  };
  message_ledger::give_accounts(accounts);
  const auto begun = bench::cpu_s();
  const auto report = run_ecology(what, options);
  x.cpu_s = std::min(x.cpu_s, bench::cpu_s() - begun);
  x.octets = std::min(x.octets, after - before);
  x.hash = report.trace_hash;
  message_ledger::give_accounts(true);
}

} // namespace

int main(int argc, char** argv) {
  unsigned runs = 5;
  bool json = false;
  CLI::App command{"What the account of messages costs"};
  command.add_option("--runs", runs, "of each kind")->check(CLI::Range(1U, 100U));
  command.add_flag("--json", json, "figures as JSON");
  CLI11_PARSE(command, argc, argv);
  spdlog::set_level(spdlog::level::off); // invariants do not hold of messages without accounts
  bench::figures out;
  auto motes = bench::mote_islands(10, 100, true);
  motes.length = 10min;
  const std::pair<const char*, config::ecology_description> all[] = {
      {"home, 2 h", file("home.toml", 2h)},
      {"Intel lab, 1 h", file("intel-lab.toml", 1h)},
      {"1 000 motes, 10 min", std::move(motes)},
      {"learning, 20 min", file("learning.toml", 20min)},
  };
  for (const auto& [name, what] : all) {
    out.section(name, "with and without accounts, the least of " + std::to_string(runs));
    cost with;
    cost without;
    measure(what, true, with); // the first one fetches memory
    with = {};
    for (unsigned i = 0; i < runs; ++i) {
      measure(what, i % 2 == 0, i % 2 == 0 ? with : without);
      measure(what, i % 2 != 0, i % 2 != 0 ? with : without);
    }
    out.add("processor time with accounts", with.cpu_s, 3, "s");
    out.add("more than without", 100 * (with.cpu_s / without.cpu_s - 1), 1, "%", bench::at_most(3));
    out.add("resident with accounts", with.octets / 1e6, 1, "MB");
    out.add("more than without", 100 * (with.octets / without.octets - 1), 1, "%",
            bench::at_most(5));
    if (with.hash != without.hash)
      out.failure("trace", "accounts change what happens");
  }
  if (json)
    out.print_json();
  return out.failures() == 0 ? 0 : 1;
}
