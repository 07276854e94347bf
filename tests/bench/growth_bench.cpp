// How cost and memory grow with what there is more and more of (NFR-06): motes, islands, peers,
// tuples, subscriptions; as tables, and as a drawing.
//
// Each size is measured in a process of its own, so that none finds the memory of another. It runs
// a calibration loop before and after, by whose steps figures of different machines and moments are
// comparable. All run in one thread and in virtual time. What takes less than a second or so is
// measured three times, and the least cost taken: other work of the machine only adds to it.
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include "actors/run/run.hpp"
#include "calibration.hpp"
#include "config/load.hpp"
#include "figures.hpp"
#include "growth_plot.hpp"
#include "io/process/spare_memory.hpp"
#include "io/process/spawn.hpp"
#include "kernel_pair.hpp"
#include "mote_islands.hpp"
#include "peis/tuples/tuple_record.hpp"

namespace {

using namespace rubicon;
using bench::cpu_s;
using bench::growth_point;
using bench::kernel_pair;

/// What one size took.
struct usage {
  double cpu_s = 0;
  double octets = 0; ///< resident, beyond what the process had before
};

void demand(bool good, const std::string& what) {
  if (!good)
    throw std::runtime_error(what);
}

double resident() {
  return static_cast<double>(io::resident_memory());
}

/// A run stops for its progress where its steps end, which double while they take little time:
/// small ecologies stop at these moments, larger ones more often. All sizes are measured between
/// the same two, since motes say less the longer nothing has changed.
constexpr duration stop(unsigned n) {
  return 1ms * ((1U << n) - 1);
}

/// A minute of an ecology that has settled.
/// @param make builds the ecology; its memory counts
/// @param from,to between these moments
/// @param check told the report
template <class Make, class Check>
usage minute_of(Make make, duration from, duration to, Check check) {
  const auto before = resident();
  config::ecology_description what = make();
  what.length = to;
  usage x;
  std::optional<std::pair<double, instant>> begun; // large ones stop elsewhere, a little later
  run_options options;
  options.threads = 1;
  options.progress = [&](const run_progress& p) {
    if (!begun && p.reached >= instant(from))
      begun = {cpu_s(), p.reached};
    if (p.reached < p.end)
      return;
    demand(begun->second - instant(from) < (to - from) / 2, "the run did not stop in time");
    x.cpu_s = (cpu_s() - begun->first) * 60 / seconds(p.end - begun->second);
    x.octets = resident() - before;
  };
  check(run_ecology(std::move(what), options));
  return x;
}

usage minute_of_motes(unsigned islands, unsigned motes) {
  return minute_of([&] { return bench::mote_islands(islands, motes, false); }, stop(17), stop(18),
                   [&](const report::run_report& report) {
                     const auto messages = report.messages();
                     demand(report.motes_joined() == islands * motes, "not all motes have joined");
                     demand(messages.received >= messages.unreliable_sent * 95 / 100,
                            "too few readings have arrived");
                   });
}

constexpr unsigned island_motes = 120; // 30 000 in as many islands as there are ids for

usage measure_motes(unsigned motes) {
  return minute_of_motes(motes / island_motes, island_motes);
}

usage measure_islands(unsigned islands) {
  return minute_of_motes(islands, 10);
}

usage measure_peers(unsigned count) {
  const auto make = [&] {
    const auto text = "[ecology]\nname = 'peers'\n[[peer]]\nid = 1\nname = 'peer'\ncount = " +
                      std::to_string(count) + '\n';
    auto loaded = config::load_text(text, "peers.toml", {}, {});
    if (!loaded.ecology)
      throw std::logic_error("the bench's own ecology is refused");
    return *std::move(loaded.ecology);
  };
  return minute_of(make, stop(16), stop(17), [&](const report::run_report& report) {
    for (const auto& x : report.peers)
      demand(x.hosts_known == count, "not all peers know each other");
  });
}

constexpr double limit_s = 300;

std::string tuple_name(unsigned i) {
  return "a.k" + std::to_string(i);
}

usage measure_tuples(unsigned count) {
  kernel_pair all;
  const auto before = resident();
  const auto begun = cpu_s();
  for (unsigned i = 0; i < count; ++i) {
    all.command(0, [&](auto& x, instant now) {
      return x.tuples().set(tuple_name(i), peis::text_content("1"), now);
    });
  }
  all.command(1, [&](auto& x, instant now) {
    return x.subscriptions().subscribe(peer_id{1}, "a.*", peis::subscription_id{1}, now);
  });
  demand(
      all.pass_until([&] { return all.at(1).counters().tuples.pushes_received >= count; }, limit_s),
      "not all tuples were pushed");
  demand(all.at(1).counters().tuples.tuples >= count, "not all tuples had room");
  return {cpu_s() - begun, resident() - before};
}

usage measure_subscriptions(unsigned count) {
  constexpr unsigned sets = 1000;
  kernel_pair all;
  const auto before = resident();
  const auto begun = cpu_s();
  for (unsigned i = 0; i < count; ++i) {
    all.command(1, [&](auto& x, instant now) {
      return x.subscriptions().subscribe(peer_id{1}, tuple_name(i),
                                         peis::subscription_id{std::uint64_t{i} + 1}, now);
    });
  }
  demand(all.pass_until([&] { return all.at(0).counters().tuples.subscribers >= count; }, limit_s),
         "not all subscriptions have come");
  for (unsigned i = 0; i < sets; ++i) {
    all.command(0, [&](auto& x, instant now) {
      return x.tuples().set(tuple_name(i), peis::text_content("1"), now);
    });
  }
  all.pass(60s);
  demand(all.at(1).counters().tuples.pushes_received >= sets, "not all tuples were pushed");
  return {cpu_s() - begun, resident() - before};
}

struct dimension {
  std::string name; ///< what there is more and more of
  std::string one;  ///< of these
  std::string work; ///< what the cost is of
  std::vector<unsigned> sizes;
  std::size_t quick; ///< so many of the sizes take little time
  usage (*measure)(unsigned size);
};

const std::vector<dimension>& dimensions() {
  static const std::vector<dimension> all = {
      {"motes",
       "mote",
       "islands of 120, a reading a minute each, for a minute",
       {120, 1200, 12'000, 30'000},
       2,
       measure_motes},
      {"islands",
       "island",
       "of 10 motes, a reading a minute each, for a minute",
       {1, 10, 100, 250},
       2,
       measure_islands},
      {"peers",
       "peer",
       "without programs, in one PEIS network, for a minute",
       {10, 30, 100, 250, 500},
       2,
       measure_peers},
      {"tuples",
       "tuple",
       "set and pushed to one subscriber",
       {1000, 10'000, 100'000, 999'000}, // those of the kernel count as well
       3,
       measure_tuples},
      {"subscriptions",
       "subscription",
       "registered, 1 000 sets, a minute of refreshing",
       {1000, 10'000, 100'000},
       2,
       measure_subscriptions},
  };
  return all;
}

/// The part of the program that runs in a process of its own: one line for the one that waits.
int measure_here(const dimension& what, unsigned size) {
  const auto rate = bench::calibrate();
  const auto x = what.measure(size);
  const auto steps = x.cpu_s * (rate + bench::calibrate()) / 2 * 1e6;
  std::printf("usage %.9g %.9g %.9g\n", x.cpu_s, steps, x.octets);
  return 0;
}

struct measurement {
  double cpu_s = 0;
  growth_point point;
};

struct ending {
  std::string out;
  std::string err;
  int status = 0; ///< as of waitpid
};

/// Waits for its end and takes all that it says.
ending collect(const io::spawned& child) {
  ending x;
  std::array<pollfd, 2> waited{pollfd{child.out, POLLIN, 0}, pollfd{child.err, POLLIN, 0}};
  const std::array<std::string*, 2> texts{&x.out, &x.err};
  while (waited[0].fd != -1 || waited[1].fd != -1) {
    ::poll(waited.data(), waited.size(), -1);
    for (std::size_t i = 0; i < waited.size(); ++i) {
      if (waited[i].fd == -1 || waited[i].revents == 0)
        continue;
      std::array<char, 4096> block{};
      const auto size = ::read(waited[i].fd, block.data(), block.size());
      if (size > 0)
        texts[i]->append(block.data(), static_cast<std::size_t>(size));
      else if (size == 0 || (errno != EAGAIN && errno != EINTR))
        ::close(std::exchange(waited[i].fd, -1));
    }
  }
  while (::waitpid(child.pid, &x.status, 0) == -1 && errno == EINTR) {
  }
  return x;
}

/// @throws std::runtime_error if the process fails
measurement measure_apart(const dimension& what, unsigned size) {
  const auto program = std::filesystem::read_symlink("/proc/self/exe").string();
  const auto end = collect(io::spawn(
      {program, {program, "--child", "--only", what.name, "--size", std::to_string(size)}}));
  std::fputs(end.err.c_str(), stderr);
  if (WIFSIGNALED(end.status))
    throw std::runtime_error("signal " + std::to_string(WTERMSIG(end.status)));
  measurement x;
  x.point.size = size;
  if (end.status != 0 || std::sscanf(end.out.c_str(), "usage %lf %lf %lf", &x.cpu_s, &x.point.steps,
                                     &x.point.octets) != 3)
    throw std::runtime_error("status " + std::to_string(WEXITSTATUS(end.status)));
  x.point.octets = std::max(x.point.octets, 1.0); // it has a logarithm
  return x;
}

measurement measure_best(const dimension& what, unsigned size, bool once) {
  constexpr int tries = 3;
  constexpr double enough_s = 2;
  const auto begun = bench::wall_s();
  std::optional<measurement> best;
  for (int i = 0; i < tries && (i == 0 || (!once && bench::wall_s() - begun < enough_s)); ++i) {
    const auto x = measure_apart(what, size);
    if (!best || x.point.steps < best->point.steps)
      best = x;
  }
  return *best;
}

void print_row(bench::figures& out, const dimension& what, const measurement& x) {
  const auto& [size, steps, octets] = x.point;
  std::printf("  %9.0f %12.3f %14.2f %18.2f %12.2f %16.2f\n", size, x.cpu_s, 1e6 * x.cpu_s / size,
              steps / size / 1e3, octets / 1e6, octets / size / 1e3);
  std::fflush(stdout);
  const auto name = std::to_string(static_cast<unsigned>(size)) + ": ";
  out.keep(name + "processor time", x.cpu_s, "s");
  out.keep(name + "processor time, a " + what.one, 1e6 * x.cpu_s / size, "us");
  out.keep(name + "the same in calibration steps", steps / size, "steps");
  out.keep(name + "memory", octets, "B");
  out.keep(name + "memory, a " + what.one, octets / size, "B");
}

std::vector<growth_point> measure_all(bench::figures& out, const dimension& what, bool quick) {
  out.section(what.name, what.work);
  std::printf("  %9s %12s %14s %18s %12s %16s\n", "size", "cpu s", "us each", "k steps each",
              "memory MB", "memory kB each");
  std::vector<growth_point> points;
  for (std::size_t i = 0; i < (quick ? what.quick : what.sizes.size()); ++i) {
    const auto size = what.sizes[i];
    std::fprintf(stderr, "bench_growth: %s, %u ...\n", what.name.c_str(), size);
    try {
      const auto x = measure_best(what, size, quick);
      print_row(out, what, x);
      points.push_back(x.point);
    } catch (const std::exception& error) {
      out.failure(std::to_string(size) + ' ' + what.name, error.what());
    }
  }
  if (points.size() < 2)
    return points;
  for (const auto& [name, member] :
       {std::pair{"cost", &growth_point::steps}, std::pair{"memory", &growth_point::octets}}) {
    const auto told = std::string("slope of ") + name;
    out.add(told, bench::slope(points, member, points.size()), 2, "");
    out.add(told + ", last two sizes", bench::slope(points, member, 2), 2, "");
  }
  return points;
}

std::string capital(std::string x) {
  x[0] = static_cast<char>(x[0] - 'a' + 'A');
  return x;
}

int run(const std::string& only, bool quick, bool json, const std::string& svg) {
  if (!svg.empty()) // told before the work rather than after it
    demand(std::ofstream(svg, std::ios::app).good(), svg + " cannot be written");
  bench::figures out;
  std::vector<bench::growth_panel> panels;
  for (const auto& what : dimensions()) {
    if (only.empty() || only == what.name)
      panels.push_back({capital(what.name), what.work, measure_all(out, what, quick)});
  }
  if (json)
    out.print_json();
  if (!svg.empty()) {
    std::ofstream file(svg);
    bench::draw_growth(file,
                       "Each size in a process of its own, in one thread and virtual time. Slopes "
                       "are powers of the size.",
                       panels);
    demand(file.flush().good(), svg + " cannot be written");
  }
  return out.failures() == 0 ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
  bool json = false;
  bool quick = false;
  bool child = false;
  unsigned size = 0;
  std::string only;
  std::string svg;
  std::vector<std::string> names;
  for (const auto& x : dimensions())
    names.push_back(x.name);
  CLI::App command{"How cost and memory grow with what there is more and more of"};
  command.add_flag("--json", json, "figures as JSON too");
  command.add_option("--svg", svg, "draw them to this file")->type_name("FILE");
  command.add_flag("--quick", quick, "small sizes only");
  command.add_option("--only", only, "what alone is measured")->check(CLI::IsMember(names));
  command.add_flag("--child", child)->group(""); // one size, in a process of its own
  command.add_option("--size", size)->group("");
  CLI11_PARSE(command, argc, argv);
  spdlog::set_level(spdlog::level::err);
  try {
    if (!child)
      return run(only, quick, json, svg);
    for (const auto& x : dimensions()) {
      if (x.name == only)
        return measure_here(x, size);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_growth: %s\n", error.what());
  }
  return 1;
}
