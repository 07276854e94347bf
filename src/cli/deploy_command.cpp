#include "cli/deploy_command.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <list>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "cli/console.hpp"
#include "cli/ecology_file.hpp"
#include "cli/logging.hpp"
#include "cli/part_file.hpp"
#include "config/placement.hpp"
#include "core/printable.hpp"
#include "io/loop.hpp"
#include "io/process.hpp"
#include "io/signal_watch.hpp"
#include "report/merge.hpp"

namespace rubicon::cli {

namespace {

using steady = std::chrono::steady_clock;

/// This binary, also after the file has been replaced by a newer one.
constexpr const char* own_binary = "/proc/self/exe";
/// From the death of a process to its next life.
constexpr duration restart_pause = 1s;
/// How long processes may take to report once they were told to end.
constexpr duration goodbye_max = 10s;
constexpr std::size_t line_octets_max = 4096;

/// Files of parts, gone with the deployment.
class work_folder {
public:
  work_folder() {
    auto name = (std::filesystem::temp_directory_path() / "rubicon-deploy-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw std::system_error(errno, std::generic_category(), name);
    path_ = name;
  }
  ~work_folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  work_folder(const work_folder&) = delete;
  work_folder& operator=(const work_folder&) = delete;

  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

private:
  std::filesystem::path path_;
};

/// A host's part: its process, and what it has told in all its lives.
struct part {
  explicit part(std::string name) { report.host = std::move(name); }

  report::host_report report;
  std::optional<io::process> process;
  std::optional<steady::time_point> starts_again;
  std::string line; ///< of its standard error, so far
};

class local_deployment {
public:
  local_deployment(const deploy_command& x, config::ecology_description ecology)
      : command_(x), ecology_(std::move(ecology)),
        signals_(loop_, [this](int) { stop(/*interrupted=*/true); }) {
    for (const auto& host : config::used_hosts(ecology_))
      parts_.emplace_back(host.name);
  }

  exit_status run() {
    for (auto& each : parts_)
      start(each);
    while (somebody_runs() && (!stopping_ || steady::now() < *stopping_ + goodbye_max)) {
      loop_.wait_until(steady::now() + 100ms);
      start_again();
    }
    for (auto& each : parts_) {
      each.process.reset(); // who has not ended by now is killed
      take_report(each);
    }
    return refused_ ? exit_status::refused : finish();
  }

private:
  [[nodiscard]] duration elapsed() const { return steady::now() - started_; }

  [[nodiscard]] bool somebody_runs() const {
    return std::ranges::any_of(
        parts_, [](const part& x) { return x.process.has_value() || x.starts_again.has_value(); });
  }

  void say(const part& x, const std::string& text) const {
    static_cast<void>(print(stderr, printable(x.report.host + "  " + text) + '\n'));
  }

  void start(part& x) {
    const auto& host = x.report.host;
    auto& life = x.report.lives.emplace_back();
    if (x.report.lives.size() > 1)
      life.elapsed = elapsed();
    io::spawn_request what;
    what.program = own_binary;
    what.words = {"rubicon",
                  "run",
                  command_.file,
                  "--host",
                  host,
                  "--log",
                  command_.log_level,
                  "--seed",
                  std::to_string(ecology_.seed),
                  "--for",
                  milliseconds(ecology_.length),
                  "--starts",
                  files_.file(host + ".starts"),
                  "--part-report",
                  report_file(x)};
    if (life.elapsed >= 1ms)
      what.words.insert(what.words.end(), {"--elapsed", milliseconds(life.elapsed)});
    auto begun = io::process::start(
        loop_, std::move(what),
        {[this, &x](io::process::output, byte_view octets) { on_output(x, octets); },
         [this, &x](io::process_end how) { on_end(x, how); }});
    if (const auto* why = std::get_if<std::string>(&begun)) {
      say(x, *why);
      refused_ = true;
      stop(/*interrupted=*/false);
    } else {
      x.process.emplace(std::get<io::process>(std::move(begun)));
    }
  }

  static std::string milliseconds(duration x) { return std::to_string(x / 1ms) + "ms"; }

  /// Each life has its own.
  [[nodiscard]] std::string report_file(const part& x) const {
    return files_.file(x.report.host + '-' + std::to_string(x.report.lives.size()) + ".report");
  }

  void on_output(part& x, byte_view octets) const {
    for (const auto octet : octets) {
      if (octet != '\n' && x.line.size() < line_octets_max)
        x.line += static_cast<char>(octet);
      else if (!x.line.empty())
        say(x, std::exchange(x.line, {}));
    }
  }

  void on_end(part& x, io::process_end how) {
    x.process.reset();
    take_report(x);
    if (stopping_)
      return;
    if (how.status == static_cast<int>(exit_status::refused)) {
      refused_ = true; // it has said why
      stop(/*interrupted=*/false);
    } else if (!x.report.lives.back().is_final && elapsed() + restart_pause < ecology_.length) {
      say(x, "has ended with " + to_string(how) + " after " + to_text(floor_seconds(elapsed())) +
                 "; it is started again");
      x.starts_again = steady::now() + restart_pause;
    }
  }

  static duration floor_seconds(duration x) { return std::chrono::floor<std::chrono::seconds>(x); }

  void start_again() {
    for (auto& each : parts_)
      if (each.starts_again && steady::now() >= *each.starts_again) {
        each.starts_again.reset();
        start(each);
      }
  }

  void take_report(part& x) const {
    auto& life = x.report.lives.back();
    if (life.is_final)
      return;
    if (auto found = read_part_file(report_file(x))) {
      life.told = std::move(found->told);
      life.is_final = found->is_final;
    }
  }

  void stop(bool interrupted) {
    if (stopping_)
      return;
    stopping_ = steady::now();
    interrupted_ = interrupted;
    for (auto& each : parts_) {
      each.starts_again.reset();
      if (each.process)
        each.process->signal(SIGINT);
    }
  }

  exit_status finish() {
    std::vector<report::host_report> all;
    for (const auto& each : parts_)
      all.push_back(each.report);
    auto whole = report::merged(ecology_, all);
    whole.interrupted = interrupted_;
    const auto output = console_of(stdout);
    const auto text = command_.json ? to_json(whole) : to_text(whole, output.width, output.colour);
    if (!print(stdout, text))
      return exit_status::refused;
    if (interrupted_)
      return exit_status::interrupted;
    return whole.complete && whole.violations.empty() ? exit_status::good : exit_status::violated;
  }

  const deploy_command& command_;
  const config::ecology_description ecology_;
  const steady::time_point started_ = steady::now();
  const work_folder files_;
  std::optional<steady::time_point> stopping_;
  bool interrupted_ = false;
  bool refused_ = false;
  io::loop loop_;
  io::signal_watch signals_;
  std::list<part> parts_; ///< processes refer to them; ends before their loop
};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words)
    text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? "nothing" : text;
}

/// What would run where, and which ports it would take.
std::string plan_text(const config::ecology_description& all) {
  std::string text;
  for (const auto& host : config::used_hosts(all)) {
    const auto part = config::part_of(all, host.name);
    const auto* const link = config::host_peer(part);
    std::vector<std::string> islands;
    std::vector<std::string> peers;
    for (const auto& each : part.islands)
      islands.push_back(each.name);
    for (const auto& each : part.peers)
      if (&each != link)
        peers.push_back(each.name);
    text += printable(host.name + "  " + host.address) +
            (link == nullptr ? "" : "  PEIS port " + std::to_string(host.peis_port)) +
            "\n  islands  " + printable(joined(islands)) + "\n  peers    " +
            printable(joined(peers)) + '\n';
  }
  return text;
}

} // namespace

exit_status perform(const deploy_command& x) {
  config::overrides instead;
  instead.seed = x.seed;
  instead.mode = config::run_mode::wall;
  auto file = load_or_complain(x.file, instead, x.known);
  if (!file)
    return exit_status::refused;
  auto problems = config::placement_problems(file->ecology);
  if (config::used_hosts(file->ecology).empty())
    problems.emplace_back("it has no [[host]]; `rubicon run` runs it in one process");
  for (const auto& each : problems)
    static_cast<void>(print(stderr, printable(x.file + ": " + each) + '\n'));
  if (!problems.empty())
    return exit_status::refused;
  if (x.dry_run)
    return print(stdout, plan_text(file->ecology)) ? exit_status::good : exit_status::refused;
  file->ecology.seed = x.seed.value_or(file->ecology.seed);
  file->ecology.length = x.length.value_or(file->ecology.length);
  return local_deployment(x, std::move(file->ecology)).run();
}

} // namespace rubicon::cli
