#include "cli/hosts/deploy_command.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cli/ecology_file.hpp"
#include "cli/hosts/ask_hosts.hpp"
#include "cli/hosts/deployed.hpp"
#include "cli/hosts/deployment.hpp"
#include "cli/hosts/local_hosts.hpp"
#include "cli/print/console.hpp"
#include "cli/print/plan_text.hpp"
#include "cli/print/report_output.hpp"
#include "cli/random_id.hpp"
#include "cli/run/live_page.hpp"
#include "cli/run/run_watch.hpp"
#include "cli/words/option_text.hpp"
#include "config/plan/placement.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"
#include "io/loop.hpp"
#include "io/process/signal_watch.hpp"
#include "io/tcp/tcp_listener.hpp"

namespace rubicon::cli {

namespace {

constexpr duration look_every = 50ms;
constexpr duration show_every = 2s;      ///< on the live page; parts report every 5 s
constexpr duration local_patience = 20s; ///< processes of a busy computer take their time

/// The file, with its hosts here if they are to be; nothing: it cannot be spread, and the reason is
/// printed.
std::optional<deploy::packed> packed_file(io::loop& loop, const deploy_command& x) {
  config::overrides instead;
  instead.seed = x.seed;
  instead.mode = config::run_mode::wall;
  auto file = deploy::pack(x.file, instead, x.length, x.known);
  complain(file.loaded, x.file);
  if (!file.loaded.ecology || !file.loaded.problems.empty())
    return std::nullopt;
  if (x.local) {
    file.what.places =
        deploy::places_on_one_computer(*file.loaded.ecology, [&loop](std::uint16_t port) {
          return io::why_taken(loop, deploy::loopback, port).empty();
        });
    deploy::place(*file.loaded.ecology, file.what.places);
  }
  auto problems = config::placement_problems(*file.loaded.ecology);
  if (config::used_hosts(*file.loaded.ecology).empty())
    problems.emplace_back("it has no [[host]]; `rubicon run` runs it in one process");
  for (const auto& each : problems)
    static_cast<void>(print(stderr, printable(x.file + ": " + each) + '\n'));
  if (!problems.empty())
    return std::nullopt;
  return file;
}

std::string command_of(const deploy_command& x, const report::run_report& run) {
  return "rubicon deploy " + shell_word(x.file) + (x.local ? " --local" : "") + " --seed " +
         std::to_string(run.seed) + (x.length ? " --for " + option_text(*x.length) : "");
}

exit_status follow(const deploy_command& x, io::loop& loop, deploy::packed file,
                   local_hosts* here) {
  const auto tls = here == nullptr ? x.tls : here->own_certificate();
  control::system actors(tls);
  const auto hosts = hosts_of(*file.loaded.ecology);
  deployment_options options;
  options.log_level = x.log_level;
  options.prints_lines = x.log_level != "off";
  options.patience = here == nullptr ? options.patience : local_patience;
  options.attach = x.attach;
  const auto name = file.loaded.ecology->name;
  const auto length = file.loaded.ecology->length;
  const auto labels = file.loaded.ecology->labels;
  const auto network = file.loaded.ecology->network;
  watch_options watch;
  watch.page_file = x.page_file;
  run_watch page(std::move(watch), *file.loaded.ecology);
  std::optional<manual_control> manual;
  if (x.control)
    manual.emplace(file.what, x.known);
  std::optional<live_page> live;
  if (x.view)
    live.emplace(*x.view, view::ecology_json(*file.loaded.ecology),
                 view::run_facts{.file = x.file, .controls = x.control}, "wall", "",
                 manual ? manual->controls("tuples of a deployment are set by `rubicon tuples set`")
                        : nullptr);
  deployment all(loop, actors, x.attach ? "" : random_id(), std::move(file), hosts, options);
  std::optional<io::signal_watch> signals(std::in_place, loop,
                                          [&all](int) { all.stop(/*interrupted=*/true); });
  std::optional<deployed> noted;
  const manual_control::performer by_hosts{
      [&all](const std::string& sentence, const config::fault&) { all.cause(sentence); }, {}};
  auto shown_at = std::chrono::steady_clock::now();
  while (all.step()) {
    loop.wait_until(std::chrono::steady_clock::now() + look_every);
    if (here != nullptr)
      here->on_time();
    if (manual && all.has_begun())
      for (const auto& each : manual->perform(by_hosts, instant(all.elapsed())))
        live->report_action(instant(all.elapsed()), each);
    if (live && all.has_begun() && std::chrono::steady_clock::now() >= shown_at) {
      live->show(all.whole_report(), length);
      shown_at = std::chrono::steady_clock::now() + show_every;
    }
    if (all.has_begun() && !noted) {
      noted =
          deployed{all.id(), name, std::filesystem::absolute(x.file).string(), hosts, tls, network};
      if (const auto why = remember(*noted); !why.empty())
        static_cast<void>(print(stderr, printable(why) + '\n'));
    }
  }
  if (noted)
    forget(*noted);
  if (all.refused())
    return exit_status::refused;
  auto report = all.whole_report();
  page.finish(report, command_of(x, report), {});
  const auto status = print_report(report, {x.json, x.full, x.brief}, labels);
  if (live && !report.interrupted) {
    live->show(report, length);
    live->finish(report);
    if (manual) {
      manual->end();
      static_cast<void>(print(stderr, manual->repeated()));
    }
    signals.reset(); // the page has its own
    live->stay();
  }
  return status;
}

/// Nobody listens there, as far as can be told from here.
bool is_unreachable(const received_verdict& x) {
  const auto* why = std::get_if<std::string>(&x);
  return why != nullptr && why->starts_with("cannot be reached");
}

/// Asks each host whether it could run its part.
exit_status ask_whether(const deploy_command& x, const deploy::packed& file) {
  control::system actors(x.tls);
  const auto hosts = hosts_of(*file.loaded.ecology);
  const auto answers = ask_hosts(actors, hosts, [&](const deployed_host& host) {
    return deploy::offer{{}, host.name, part_of(file, host.name), x.log_level, /*only_asks=*/true};
  });
  std::string text;
  bool all_could = true;
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    auto problems = problems_of(answers[i]);
    all_could = all_could && problems.empty();
    if (problems.empty())
      problems.emplace_back("can run it");
    for (const auto& each : problems)
      text += printable(hosts[i].name + "  " + each) + '\n';
    if (is_unreachable(answers[i]))
      text += printable(hosts[i].name +
                        "  start there: " + host_command_line(hosts[i], !x.tls.empty())) +
              '\n';
  }
  if (!print(stdout, text))
    return exit_status::refused;
  return all_could ? exit_status::good : exit_status::failed;
}

} // namespace

exit_status perform(const deploy_command& x) {
  io::loop loop;
  auto file = packed_file(loop, x);
  if (!file)
    return exit_status::refused;
  if (x.dry_run) {
    if (!print(stdout, plan_text(*file->loaded.ecology)))
      return exit_status::refused;
    return x.local ? exit_status::good : ask_whether(x, *file);
  }
  if (!x.local)
    return follow(x, loop, *std::move(file), nullptr);
  local_hosts here(loop, hosts_of(*file->loaded.ecology));
  return follow(x, loop, *std::move(file), &here);
}

} // namespace rubicon::cli
