// What the account of messages costs: whole ecologies with it and without it, in turn, each run in
// a process of its own. In one process a run finds the memory that the runs before it have freed,
// in pieces: what it adds to that differs from run to run by more than accounts take.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "actors/run/run.hpp"
#include "calibration.hpp"
#include "config/load.hpp"
#include "core/account/message_ledger.hpp"
#include "figures.hpp"
#include "mote_islands.hpp"

namespace {

using namespace rubicon;

struct cost {
  double cpu_s = 1e9;   ///< least of all runs
  double octets = 1e18; ///< of memory at the end, without what was before; least of all runs
  std::string hash;
};

/// Resident memory that no file backs, in octets: code is resident once it has been executed.
double own_memory() {
  auto* const file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr)
    return 0;
  long resident = 0;
  long of_files = 0;
  const int found = std::fscanf(file, "%*d %ld %ld", &resident, &of_files);
  std::fclose(file);
  return found == 2 ? static_cast<double>((resident - of_files) * ::sysconf(_SC_PAGESIZE)) : 0;
}

config::ecology_description file(const std::string& name, duration length) {
  auto loaded = config::load_file(RUBICON_CONFIG_DIR "/" + name);
  if (!loaded.ecology)
    throw std::runtime_error(name + " cannot be read");
  loaded.ecology->length = length;
  return *std::move(loaded.ecology);
}

cost measure(const config::ecology_description& what, bool accounts) {
  const auto before = own_memory();
  cost x;
  run_options options;
  options.progress = [&](const run_progress& p) {
    if (p.reached >= p.end)
      x.octets = own_memory() - before;
  };
  message_ledger::give_accounts(accounts);
  const auto begun = bench::cpu_s();
  x.hash = run_ecology(what, options).trace_hash;
  x.cpu_s = bench::cpu_s() - begun;
  return x;
}

/// The part of the program that runs in a process of its own: one line for the one that waits.
[[noreturn]] void measure_for(int reader, const config::ecology_description& what, bool accounts) {
  int status = 1;
  try {
    const auto x = measure(what, accounts);
    if (::dprintf(reader, "%.9g %.9g %s", x.cpu_s, x.octets, x.hash.c_str()) > 0)
      status = 0;
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s\n", problem.what());
  }
  ::_exit(status);
}

/// @throws std::runtime_error if the process fails
void measure_apart(const config::ecology_description& what, bool accounts, cost& least) {
  std::array<int, 2> ends{};
  const auto child = ::pipe(ends.data()) == 0 ? ::fork() : -1;
  if (child == -1)
    throw std::runtime_error("there is no other process");
  if (child == 0)
    measure_for(ends[1], what, accounts);
  ::close(ends[1]);
  std::array<char, 100> line{}; // a pipe hands a line of this size over in one piece
  const auto size = ::read(ends[0], line.data(), line.size() - 1);
  ::close(ends[0]);
  while (::waitpid(child, nullptr, 0) == -1 && errno == EINTR) {
  }
  std::array<char, 100> hash{};
  cost x;
  if (size <= 0 || std::sscanf(line.data(), "%lf %lf %99s", &x.cpu_s, &x.octets, hash.data()) != 3)
    throw std::runtime_error("a run has failed");
  least = {std::min(x.cpu_s, least.cpu_s), std::min(x.octets, least.octets), hash.data()};
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
  // Of the memory that a large page holds, a run may use very little. Ignored where there are none.
  static_cast<void>(::prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0));
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
    for (unsigned i = 0; i < runs; ++i) {
      measure_apart(what, i % 2 == 0, i % 2 == 0 ? with : without);
      measure_apart(what, i % 2 != 0, i % 2 != 0 ? with : without);
    }
    out.add("processor time with accounts", with.cpu_s, 3, "s");
    out.add("more than without", 100 * (with.cpu_s / without.cpu_s - 1), 1, "%", bench::at_most(3));
    out.add("memory with accounts", with.octets / 1e6, 1, "MB");
    out.add("more than without", 100 * (with.octets / without.octets - 1), 1, "%",
            bench::at_most(5));
    if (with.hash != without.hash)
      out.failure("trace", "accounts change what happens");
  }
  if (json)
    out.print_json();
  return out.failures() == 0 ? 0 : 1;
}
