#include "cli/hosts/swarm_command.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "cli/ecology_file.hpp"
#include "cli/hosts/swarm_hosts.hpp"
#include "cli/print/console.hpp"
#include "cli/print/swarm_output.hpp"
#include "cli/run/child_runs.hpp"
#include "cli/swarm.hpp"
#include "config/load.hpp"
#include "config/plan/placement.hpp"
#include "config/run/fault_variation.hpp"
#include "config/toml/units.hpp"
#include "core/text/host_port.hpp"
#include "core/text/printable.hpp"
#include "deploy/bundle.hpp"
#include "io/loop.hpp"
#include "io/process/signal_watch.hpp"

namespace rubicon::cli {

namespace {

using steady = std::chrono::steady_clock;

/// The runs on this computer; what they mean is decided in `swarm`.
class swarm_runs {
public:
  swarm_runs(const swarm_command& x, const swarm_words& words)
      : words_(words), seeds_(x.seeds), out_(x, seeds_, words), runs_(x.timeout) {}

  exit_status run_all() {
    for (start_some(); runs_.size() > 0 && !runs_.interrupted() && out_.is_read(); start_some()) {
      for (auto& each : runs_.wait(out_.drawn_every()))
        collect(each);
      out_.draw_progress();
    }
    runs_.kill_all();
    if (runs_.interrupted())
      out_.add(seeds_.give_up());
    return out_.finish(runs_.interrupted());
  }

private:
  void start_some() {
    while (runs_.size() < words_.jobs) {
      const auto seed = seeds_.next();
      if (!seed)
        return;
      runs_.start(*seed, run_words(words_.file, *seed, words_.length, words_.settings));
    }
  }

  void collect(const child_runs::ended_run& x) {
    if (runs_.interrupted())
      return;
    if (auto outcome = judge(x.id, x.how, x.real, x.overran))
      out_.add(seeds_.ended(*std::move(outcome)));
    else
      runs_.interrupt(); // the same Ctrl-C that comes to us
  }

  const swarm_words words_;
  swarm seeds_;
  swarm_output out_;
  child_runs runs_;
};

/// `[[host]]` of the file, or ADDRESS:PORT. @returns why there is none
std::variant<deployed_host, std::string> find_host(const config::ecology_description& all,
                                                   const std::string& name) {
  if (const auto* host = config::find_host(all, name))
    return deployed_host{name, host->address, host->control_port};
  if (const auto found = parse_host_port(name))
    return deployed_host{name, found->host, found->port};
  return '`' + name + "` is neither a [[host]] of the file nor ADDRESS:PORT";
}

/// Kinds of faults that each seed leaves out or not.
std::vector<std::string> kinds_in(const swarm_words& x, std::uint64_t seed) {
  const auto found = config::resolve(x.text, x.file, x.settings, seed);
  const auto* root = std::get_if<config::node>(&found);
  return root == nullptr ? std::vector<std::string>() : config::varied_kinds(*root);
}

exit_status refuse(const swarm_command& x, const std::string& why) {
  say(x.file + ": " + why);
  return exit_status::refused;
}

exit_status run_on_hosts(const swarm_command& x, const config::overrides& instead,
                         swarm_words words) {
  std::optional<duration> length;
  if (!x.length.empty())
    length = config::parse_duration(x.length);
  auto file = deploy::pack(x.file, instead, length, x.known);
  complain(file.loaded, x.file);
  if (!file.loaded.ecology || !file.loaded.problems.empty())
    return exit_status::refused;
  words.from_wall = file.loaded.ecology->mode == config::run_mode::wall;
  std::vector<deployed_host> hosts;
  for (const auto& name : x.hosts) {
    const auto found = find_host(*file.loaded.ecology, name);
    if (const auto* why = std::get_if<std::string>(&found))
      return refuse(x, *why);
    hosts.push_back(std::get<deployed_host>(found));
  }
  bool interrupted = false;
  io::loop loop;
  const io::signal_watch signals(loop, [&](int) { interrupted = true; });
  control::system actors(x.tls);
  swarm seeds(x.seeds);
  swarm_output out(x, seeds, std::move(words));
  swarm_hosts runs(loop, actors, hosts, std::move(file.what), x.timeout, seeds, out);
  while (runs.step() && !interrupted && out.is_read())
    loop.wait_until(steady::now() + 20ms);
  runs.end();
  if (runs.refused())
    return exit_status::refused; // each has said why
  if (interrupted)
    out.add(seeds.give_up());
  return out.finish(interrupted);
}

} // namespace

exit_status perform(const swarm_command& x) {
  config::overrides instead;
  instead.seed = x.seeds.first;
  instead.mode = config::run_mode::virtual_time;
  swarm_words words{x.file, x.length, x.jobs.value_or(std::thread::hardware_concurrency())};
  words.jobs = std::max<std::uint64_t>(words.jobs, 1);
  words.settings = x.settings;
  if (x.varies_faults)
    words.settings.push_back("ecology." + std::string(config::vary_faults_key) + "=true");
  instead.settings = words.settings;
  words.text = config::read_file(x.file, config::file_octets_max).text.value_or("");
  words.fault_kinds = kinds_in(words, x.seeds.first);
  if (!x.hosts.empty())
    return run_on_hosts(x, instead, words);
  const auto file = load_or_complain(x.file, instead, x.known);
  if (!file)
    return exit_status::refused;
  words.from_wall = file->ecology.mode == config::run_mode::wall;
  return swarm_runs(x, words).run_all();
}

} // namespace rubicon::cli
