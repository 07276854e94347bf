// Days of an ecology, and whether its memory and its work stay what they were (NFR-09).
#include <malloc.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <spdlog/spdlog.h>

#include "actors/run/run.hpp"
#include "config/load.hpp"
#include "config/toml/units.hpp"
#include "io/process/spare_memory.hpp"

using namespace rubicon;

namespace {

constexpr const char* usage =
    "usage: soak FILE [--for TIME] [--settle TIME] [--growth-max MB] [--battery CHARGE]\n"
    "            [--wall SPEED] [--seed N]\n"
    "  --for         ecology time to run; default 1d\n"
    "  --settle      what tables may take to fill; growth counts from then on; default a tenth\n"
    "  --growth-max  how much more memory the end may take than the settled ecology; default 1\n"
    "  --battery     in place of that of each mote\n"
    "  --wall        in wall time, so many times faster than the real clock\n";

struct arguments {
  std::string file;
  duration length = 24h;
  std::optional<duration> settle;
  double growth_max_mb = 1;
  std::optional<double> battery_mah;
  double wall_speed = 0; ///< 0: virtual time
  std::uint64_t seed = 1;
};

[[noreturn]] void refuse(const std::string& why) {
  std::fprintf(stderr, "soak: %s\n%s", why.c_str(), usage);
  std::exit(2);
}

template <class T>
T checked(std::optional<T> x, std::string_view text) {
  if (!x)
    refuse("cannot read '" + std::string(text) + "'");
  return *x;
}

double number_of(const std::string& text) {
  char* end = nullptr;
  const auto x = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(x > 0))
    refuse("cannot read '" + text + "'");
  return x;
}

arguments parse(int argc, char** argv) {
  arguments x;
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    if (!option.starts_with("--")) {
      x.file = option;
      continue;
    }
    if (++i == argc)
      refuse("'" + std::string(option) + "' needs a value");
    const std::string value = argv[i];
    if (option == "--for")
      x.length = checked(config::parse_duration(value), value);
    else if (option == "--settle")
      x.settle = checked(config::parse_duration(value), value);
    else if (option == "--growth-max")
      x.growth_max_mb = number_of(value);
    else if (option == "--battery")
      x.battery_mah = checked(config::parse_charge_mah(value), value);
    else if (option == "--wall")
      x.wall_speed = number_of(value);
    else if (option == "--seed")
      x.seed = static_cast<std::uint64_t>(number_of(value));
    else
      refuse("there is no '" + std::string(option) + "'");
  }
  if (x.file.empty())
    refuse("which ecology?");
  return x;
}

double resident_mb() {
  return static_cast<double>(io::resident_memory()) / 1e6;
}

double heap_mb() {
  const auto x = ::mallinfo2();
  return static_cast<double>(x.uordblks + x.hblkhd) / 1e6;
}

struct sample {
  duration at;
  double resident_mb;
  double heap_mb;
  std::uint64_t events;
};

/// Least squares: MB a day of what is in use on the heap.
double heap_slope(const std::vector<sample>& samples) {
  double n = 0, t = 0, m = 0, tt = 0, tm = 0;
  for (const auto& x : samples) {
    const auto day = std::chrono::duration<double>(x.at) / 24h;
    n += 1, t += day, m += x.heap_mb, tt += day * day, tm += day * x.heap_mb;
  }
  const auto spread = n * tt - t * t;
  return spread > 0 ? (n * tm - t * m) / spread : 0;
}

config::ecology_description load(const arguments& x) {
  auto loaded = config::load_file(x.file);
  for (const auto& problem : loaded.problems)
    std::fprintf(stderr, "%s\n", to_string(problem).c_str());
  if (!loaded.ecology)
    std::exit(2);
  if (x.battery_mah)
    for (auto& island : loaded.ecology->islands)
      for (auto& mote : island.motes)
        mote.battery_mah = x.battery_mah;
  return *loaded.ecology;
}

void print(const sample& x, const sample& before) {
  const auto hours = std::chrono::duration<double>(x.at - before.at) / 1h;
  std::printf("%9.2f h  resident %8.2f MB  heap %8.3f MB  %10.0f events an hour\n",
              std::chrono::duration<double>(x.at) / 1h, x.resident_mb, x.heap_mb,
              hours > 0 ? static_cast<double>(x.events - before.events) / hours : 0);
  std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv) {
  const auto wanted = parse(argc, argv);
  spdlog::set_level(spdlog::level::warn); // what happens in days is for the report
  const auto settled = instant(wanted.settle.value_or(wanted.length / 10));
  const auto ecology = load(wanted);

  std::vector<sample> samples; // since the ecology has settled
  sample printed{};
  run_options options;
  options.length = wanted.length;
  options.seed = wanted.seed;
  options.mode = wanted.wall_speed > 0 ? config::run_mode::wall : config::run_mode::virtual_time;
  options.speed = wanted.wall_speed;
  options.handle_signals = true;
  options.progress = [&](const run_progress& x) {
    const sample now{x.reached.time_since_epoch(), resident_mb(), heap_mb(), x.events};
    if (now.at - printed.at >= wanted.length / 16) {
      print(now, printed);
      printed = now;
    }
    if (x.reached >= settled)
      samples.push_back(now);
  };
  const auto report = run_ecology(ecology, options);

  if (samples.size() < 2 || report.interrupted || !report.complete) {
    std::printf("soak: ended early: %s\n", report.complete ? "stopped" : report.reason.c_str());
    return 1;
  }
  const auto& first = samples.front();
  const auto& last = samples.back();
  const auto days = std::chrono::duration<double>(last.at - first.at) / 24h;
  const auto slope = heap_slope(samples);
  const auto growth = last.resident_mb - first.resident_mb;
  std::printf("%s, seed %" PRIu64 ": %.1f days after it had settled, resident memory grew by %.2f "
              "MB, the heap by %.1f kB a day; %zu violations\n",
              wanted.file.c_str(), wanted.seed, days, growth, slope * 1000,
              report.violations.size());
  for (const auto& each : report.violations)
    std::printf("soak: %s: %s\n", each.invariant.c_str(), each.detail.c_str());
  const bool flat = growth <= wanted.growth_max_mb && slope * days <= wanted.growth_max_mb;
  if (!flat)
    std::printf("soak: more than %.2f MB\n", wanted.growth_max_mb);
  return flat && report.violations.empty() ? 0 : 1;
}
