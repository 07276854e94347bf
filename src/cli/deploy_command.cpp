#include "cli/deploy_command.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cli/ask_hosts.hpp"
#include "cli/console.hpp"
#include "cli/deployed.hpp"
#include "cli/deployment.hpp"
#include "cli/ecology_file.hpp"
#include "cli/local_hosts.hpp"
#include "cli/plan_text.hpp"
#include "cli/random_id.hpp"
#include "config/placement.hpp"
#include "core/printable.hpp"
#include "io/loop.hpp"
#include "io/signal_watch.hpp"
#include "io/tcp_listener.hpp"

namespace rubicon::cli {

namespace {

constexpr duration look_every = 50ms;
constexpr duration local_patience = 20s; ///< processes of a busy computer take their time

bool is_free(io::loop& loop, std::uint16_t port) {
  const auto opened = io::tcp_listener::open(loop, "127.0.0.1", port, [](auto&&...) {});
  const auto* listener = std::get_if<io::tcp_listener>(&opened);
  return listener != nullptr && listener->port() == port;
}

std::vector<deployed_host> hosts_of(const config::ecology_description& all) {
  std::vector<deployed_host> out;
  for (const auto& host : config::used_hosts(all))
    out.push_back({host.name, host.address, host.control_port});
  return out;
}

/// The file, with its hosts here if they are to be; nothing: it cannot be spread, and that is told.
std::optional<deploy::packed> packed_file(io::loop& loop, const deploy_command& x) {
  config::overrides instead;
  instead.seed = x.seed;
  instead.mode = config::run_mode::wall;
  auto file = deploy::pack(x.file, instead, x.length, x.known);
  complain(file.loaded, x.file);
  if (!file.loaded.ecology || !file.loaded.problems.empty())
    return std::nullopt;
  if (x.local) {
    file.what.places = deploy::places_on_one_computer(
        *file.loaded.ecology, [&loop](std::uint16_t port) { return is_free(loop, port); });
    file.loaded = deploy::load(file.what, instead, x.known);
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

exit_status report_of(const deploy_command& x, const deployment& all) {
  const auto whole = all.whole_report();
  const auto output = console_of(stdout);
  const auto text = x.json ? to_json(whole) : to_text(whole, output.width, output.colour);
  if (!print(stdout, text))
    return exit_status::refused;
  if (whole.interrupted)
    return exit_status::interrupted;
  return whole.complete && whole.violations.empty() ? exit_status::good : exit_status::violated;
}

exit_status follow(const deploy_command& x, io::loop& loop, deploy::packed file,
                   local_hosts* here) {
  const auto tls = here == nullptr ? x.tls : here->own_certificate();
  control::system actors(tls);
  const auto hosts = hosts_of(*file.loaded.ecology);
  deployment_options options;
  options.log_level = x.log_level;
  options.tells_lines = x.log_level != "off";
  options.patience = here == nullptr ? options.patience : local_patience;
  options.attach = x.attach;
  const auto name = file.loaded.ecology->name;
  deployment all(loop, actors, x.attach ? "" : random_id(), std::move(file.what),
                 *std::move(file.loaded.ecology), hosts, options);
  const io::signal_watch signals(loop, [&all](int) { all.stop(/*interrupted=*/true); });
  std::optional<deployed> told;
  while (all.step()) {
    loop.wait_until(std::chrono::steady_clock::now() + look_every);
    if (here != nullptr)
      here->on_time();
    if (all.has_begun() && !told) {
      told = deployed{all.id(), name, std::filesystem::absolute(x.file).string(), hosts, tls};
      if (const auto why = remember(*told); !why.empty())
        static_cast<void>(print(stderr, printable(why) + '\n'));
    }
  }
  if (told)
    forget(*told);
  return all.refused() ? exit_status::refused : report_of(x, all);
}

/// Asks each host whether it could run its part.
exit_status ask_whether(const deploy_command& x, const deploy::packed& file) {
  control::system actors(x.tls);
  const auto hosts = hosts_of(*file.loaded.ecology);
  const auto answers = ask_hosts(actors, hosts, [&](const deployed_host& host) {
    return deploy::offer{{}, host.name, file.what, x.log_level, /*only_asks=*/true};
  });
  std::string text;
  bool all_could = true;
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    std::vector<std::string> problems;
    if (const auto* why = std::get_if<std::string>(&answers[i]))
      problems.push_back(*why);
    else
      problems = std::get<deploy::verdict>(std::get<deploy::answer>(answers[i])).problems;
    all_could = all_could && problems.empty();
    if (problems.empty())
      problems.emplace_back("could run it");
    for (const auto& each : problems)
      text += printable(hosts[i].name + "  " + each) + '\n';
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
