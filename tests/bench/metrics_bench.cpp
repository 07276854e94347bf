// What metrics cost a run of many motes, and how long who collects them waits (docs/metrics.md).
// Times of the run are of its thread alone, which a shared machine's other work hardly changes.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "actors/run/ecology_run.hpp"
#include "calibration.hpp"
#include "cli/print/served_metrics.hpp"
#include "core/numbers/report_schedule.hpp"
#include "figures.hpp"
#include "mote_islands.hpp"
#include "report/print/metrics.hpp"

namespace {

using namespace rubicon;
using bench::at_most;
using bench::cpu_s;
using bench::wall_s;

constexpr unsigned island_motes = 100;
constexpr int repetitions = 9;

double median(std::vector<double> x) {
  std::ranges::sort(x);
  return x[x.size() / 2];
}

/// What is answered to one request on a connection of its own.
std::string scraped(std::uint16_t port) {
  const auto connection = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(connection, reinterpret_cast<sockaddr*>(&to), sizeof to) != 0)
    throw std::runtime_error("nobody listens");
  const std::string request =
      "GET /metrics HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n";
  static_cast<void>(::send(connection, request.data(), request.size(), MSG_NOSIGNAL));
  std::string text;
  std::vector<char> some(1 << 20);
  for (ssize_t n = 0; (n = ::recv(connection, some.data(), some.size(), 0)) > 0;)
    text.append(some.data(), static_cast<std::size_t>(n));
  ::close(connection);
  return text;
}

/// Served as `run --metrics` does.
void measure_scrapes(bench::figures& out, const report::run_report& report, bool of_motes) {
  const std::string what = of_motes ? "of motes: " : "of islands: ";
  const auto begun = cpu_s();
  const auto octets = report::to_metrics(report, {.motes = of_motes}).size();
  out.add(what + "text made, beside the run", 1000 * (cpu_s() - begun), 1, "ms");
  out.add(what + "text", static_cast<double>(octets) / 1e6, 2, "MB");
  cli::metrics_place where;
  where.motes = of_motes;
  cli::served_metrics served(where);
  const auto handed = cpu_s();
  served.show(report);
  out.add(what + "handed over", 1000 * (cpu_s() - handed), 2, "ms");
  while (scraped(served.port()).size() < octets)
    ::usleep(10'000);
  std::vector<double> took;
  for (int i = 0; i < repetitions; ++i) {
    const auto asked = wall_s();
    if (scraped(served.port()).size() < octets)
      throw std::runtime_error("only a part was served");
    took.push_back(1000 * (wall_s() - asked));
  }
  out.add(what + "a scrape", median(took), 1, "ms", at_most(50));
}

void measure(bench::figures& out, unsigned motes) {
  out.section("metrics", std::to_string(motes) + " motes in islands of " +
                             std::to_string(island_motes) + ", a reading a minute");
  ecology_run run(bench::mote_islands(motes / island_motes, island_motes, false), {});
  run.run_until(instant(2min));
  std::vector<double> took;
  report::run_report report;
  for (int i = 0; i < repetitions; ++i) {
    const auto asked = cpu_s();
    report = run.report_so_far();
    took.push_back(cpu_s() - asked);
  }
  out.add("a report of all", 1000 * median(took), 1, "ms");
  out.add("for each mote", 1e6 * median(took) / motes, 1, "us");
  const auto cost =
      std::chrono::duration_cast<duration>(std::chrono::duration<double>(median(took)));
  report_schedule schedule(cli::served_metrics::collect_every);
  schedule.on_report({}, cost);
  auto next = cost;
  while (!schedule.is_due(next))
    next += 10ms;
  out.add("the next report follows after", seconds(next), 1, "s");
  out.add("of the run's time", 100 * median(took) / seconds(next), 2, "%", at_most(1));
  measure_scrapes(out, report, /*of_motes=*/false);
  measure_scrapes(out, report, /*of_motes=*/true);
  static_cast<void>(run.finish());
}

} // namespace

int main(int argc, char** argv) {
  CLI::App app("What metrics cost.");
  unsigned motes = 10'000;
  bool json = false;
  app.add_option("--motes", motes, "How many")->check(CLI::Range(100, 25'000));
  app.add_flag("--json", json, "Print figures as JSON, too");
  CLI11_PARSE(app, argc, argv);
  bench::figures out;
  try {
    measure(out, motes);
  } catch (const std::exception& x) {
    out.failure("metrics", x.what());
  }
  if (json)
    out.print_json();
  return out.failures() == 0 ? 0 : 1;
}
