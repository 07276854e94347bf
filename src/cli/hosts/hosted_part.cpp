#include "cli/hosts/hosted_part.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <system_error>
#include <utility>
#include <variant>

#include <unistd.h>

#include "cli/own_binary.hpp"
#include "cli/random_id.hpp"
#include "cli/run/bundle_file.hpp"
#include "cli/run/part_file.hpp"
#include "cli/words/exit_status.hpp"
#include "config/plan/placement.hpp"
#include "core/text/printable.hpp"
#include "deploy/fault_sentence.hpp"
#include "io/files/replace_file.hpp"
#include "io/process/machine.hpp"
#include "io/serial/serial_devices.hpp"
#include "io/tcp/tcp_listener.hpp"

namespace rubicon::cli {

namespace {

namespace fs = std::filesystem;

/// From the death of a process to its next life; twice as long each time, while it dies early.
constexpr duration restart_pause_min = 1s;
constexpr duration restart_pause_max = 30s;
constexpr duration early = 10s;
/// The report of each is stored.
constexpr std::size_t lives_max = 1000;
/// Longer than any run: times can be added without a thought.
constexpr duration length_max = std::chrono::years(100);
/// Reports in one answer.
constexpr std::size_t lives_sent_max = 16;

config::overrides wall() {
  config::overrides instead;
  instead.mode = config::run_mode::wall;
  return instead;
}

std::string milliseconds(duration x) {
  return std::to_string(x / 1ms) + "ms";
}

/// A link in a path could lead anywhere.
bool leads_over_link(const fs::path& folder, const std::string& path) {
  auto at = folder;
  for (const auto& part : fs::path(path)) {
    at /= part;
    std::error_code none;
    if (fs::is_symlink(fs::symlink_status(at, none)))
      return true;
  }
  return false;
}

/// Of what may not be opened.
std::string why_missing(const std::string& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error))
             ? ""
             : std::make_error_code(std::errc::no_such_file_or_directory).message();
}

std::uint64_t memory_of(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/statm");
  std::uint64_t all = 0;
  std::uint64_t resident = 0;
  in >> all >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

deploy::verdict refusal(std::string why) {
  return {{std::move(why)}, true};
}

} // namespace

hosted_part::hosted_part(io::loop& loop, const hosting& with,
                         std::function<void(const std::string&)> say)
    : loop_(loop), with_(with), say_(std::move(say)), next_life_(random_number()) {}

hosted_part::~hosted_part() = default;

bool hosted_part::has(const std::string& deployment) const {
  return part_ && part_->id == deployment;
}

bool hosted_part::is_running() const {
  return part_ && (part_->state == deploy::part_state::running ||
                   part_->state == deploy::part_state::waiting);
}

fs::path hosted_part::file(const std::string& name) const {
  return with_.folder / (with_.host + name);
}

std::vector<std::string> hosted_part::problems_of(const deploy::offer& x,
                                                  const config::loaded& loaded) const {
  if (x.host != with_.host)
    return {"this is host `" + with_.host + "`, not `" + x.host + '`'};
  if (x.what.length <= duration{} || x.what.length > length_max)
    return {"it would run for " + to_text(x.what.length)};
  if (is_running())
    return {"it already runs `" + part_->ecology.name +
            "`: `rubicon stop` ends it, `--attach` follows it"};
  std::vector<std::string> out;
  for (const auto& each : loaded.problems)
    out.push_back(to_string(each));
  if (!loaded.ecology)
    return out;
  out = config::placement_problems(*loaded.ecology);
  const auto used = config::used_hosts(*loaded.ecology);
  if (std::ranges::find(used, x.host, &config::host_description::name) == used.end())
    out.push_back("nothing is placed on host `" + x.host + '`');
  if (!out.empty())
    return out;
  const auto ours = config::part_of(*loaded.ecology, x.host);
  for (const auto& peer : ours.peers)
    if (peer.tcp && peer.tcp->port) {
      const auto& address = peer.tcp->address.empty() ? "127.0.0.1" : peer.tcp->address;
      if (auto why = io::why_taken(loop_, address, *peer.tcp->port); !why.empty())
        out.push_back(std::move(why));
    }
  for (const auto& island : ours.islands)
    for (const auto* outside : {&island.outside, &island.real.outside}) {
      if (outside->device.empty())
        continue;
      const auto what = outside == &island.outside ? "the sink" : "the base station";
      const bool is_ours = deploy::is_allowed(outside->device, with_.access.devices);
      const auto why = is_ours ? io::why_closed(outside->device) : why_missing(outside->device);
      if (!why.empty())
        out.push_back(std::string(what) + " of island `" + island.name + "` is at " +
                      outside->device + ": " + why +
                      "; `rubicon doctor` on this host lists the ports");
    }
  for (auto& each : deploy::refusals(ours, with_.access))
    out.push_back(std::move(each));
  for (const auto& path : deploy::files_written(ours))
    if (deploy::is_inside(path) && leads_over_link(with_.files, path))
      out.push_back('`' + path + "` contains a symbolic link in " + with_.files.string());
  return out;
}

deploy::verdict hosted_part::offer(deploy::offer x) {
  auto loaded = deploy::load(x.what, wall(), with_.known);
  deploy::verdict out{problems_of(x, loaded), true};
  if (x.only_asks || !out.problems.empty())
    return out;
  if (auto why = write_bundle(file(".bundle").string(), x.what); !why.empty())
    return refusal(std::move(why));
  part_.emplace();
  part_->id = x.deployment;
  part_->ecology = *std::move(loaded.ecology);
  part_->files_hash = hash_of(x.what);
  part_->what = std::move(x.what);
  part_->log_level = std::move(x.log_level);
  take_over_lives();
  return out;
}

deploy::verdict hosted_part::begin(const deploy::begin_part& x) {
  if (!has(x.deployment))
    return refusal("that deployment is no longer offered here");
  if (part_->state != deploy::part_state::offered)
    return {};
  if (x.elapsed < duration{} || x.elapsed > part_->what.length)
    return refusal("it cannot have run for " + to_text(x.elapsed) + " elsewhere");
  part_->began = steady::now() - x.elapsed;
  say_("begins `" + part_->ecology.name + '`');
  start();
  return part_->refused ? refusal("its process cannot be started") : deploy::verdict{};
}

void hosted_part::start() {
  auto& x = *part_;
  auto& now = x.lives.emplace_back();
  now.number = next_life_++;
  if (x.lives.size() > 1 || elapsed() > restart_pause_min)
    now.elapsed = elapsed();
  now.file = report_file(x.lives.size());
  now.change = ++x.changes;
  std::error_code ignored;
  fs::remove(now.file, ignored); // an earlier service of this host may have left one
  keep_lives();
  io::spawn_request what;
  what.program = own_binary;
  what.feeds = true;
  what.folder = with_.files.string();
  what.words = {"rubicon",
                "run",
                file(".bundle").string(),
                "--bundled",
                "--host",
                with_.host,
                "--log",
                x.log_level,
                "--starts",
                (with_.folder / (x.ecology.name + '-' + with_.host + ".starts")).string(),
                "--part-report",
                now.file.string()};
  if (now.elapsed >= 1ms)
    what.words.insert(what.words.end(), {"--elapsed", milliseconds(now.elapsed)});
  auto begun = io::process::start(
      loop_, std::move(what),
      {[this](io::process::output from, byte_view octets) {
         auto& lines = from == io::process::output::out ? out_ : err_;
         lines.take(octets, [this](const std::string& line) { part_->log.add(line); });
       },
       [this](io::process_end how) { on_end(how); }});
  if (const auto* why = std::get_if<std::string>(&begun)) {
    note(*why);
    x.refused = true;
    x.state = deploy::part_state::ended;
    return;
  }
  process_.emplace(std::get<io::process>(std::move(begun)));
  x.state = deploy::part_state::running;
}

void hosted_part::on_end(io::process_end how) {
  process_.reset();
  auto& x = *part_;
  auto& last = x.lives.back();
  last.file_written = {}; // the last report may bear the time of the one before it
  take_report(last);
  last.ended = elapsed();
  last.change = ++x.changes;
  keep_lives();
  const bool is_over = x.ending || last.is_final;
  x.refused = x.lives.size() == 1 && how.status == static_cast<int>(exit_status::refused);
  x.pause = elapsed() - last.elapsed < early
                ? std::clamp(2 * x.pause, restart_pause_min, restart_pause_max)
                : restart_pause_min;
  if (x.lives.size() >= lives_max && !is_over)
    note("has died " + std::to_string(lives_max) + " times, and is not restarted");
  if (is_over || x.refused || x.lives.size() >= lives_max || elapsed() + x.pause >= x.what.length) {
    if (!last.is_final && !x.refused)
      note("has ended with " + to_string(how) + " without a last report");
    x.state = deploy::part_state::ended;
    say_('`' + x.ecology.name + "` has ended");
    return;
  }
  x.state = deploy::part_state::waiting;
  x.begins_again = steady::now() + x.pause;
  note("has ended with " + to_string(how) + " after " +
       to_text(std::chrono::floor<std::chrono::seconds>(elapsed())) + "; it is restarted");
}

void hosted_part::note(const std::string& line) {
  part_->log.add(line);
  say_(line);
}

void hosted_part::on_time() {
  if (part_ && part_->state == deploy::part_state::waiting && steady::now() >= part_->begins_again)
    start();
}

deploy::verdict hosted_part::cause(const deploy::cause_fault& x) {
  if (!has(x.deployment) || !process_)
    return refusal("it is not running");
  const auto found = deploy::fault_of(part_->what, x.sentence, with_.known);
  if (const auto* why = std::get_if<std::string>(&found))
    return refusal(*why);
  const auto& fault = std::get<config::fault>(found);
  const auto hosts = config::hosts_of(part_->ecology, fault);
  if (std::ranges::find(hosts, with_.host) == hosts.end())
    return {{}, false};
  if (auto why = lacks(part_->what, part_->ecology, fault); !why.empty())
    return refusal(std::move(why));
  if (!process_->feed("fault " + x.sentence + '\n'))
    return refusal("its process does not accept commands now");
  return {};
}

deploy::verdict hosted_part::end(const deploy::end_part& x) {
  if (!has(x.deployment))
    return refusal("that deployment is not on this host");
  end_all();
  return {};
}

void hosted_part::end_all() {
  if (!is_running())
    return;
  part_->ending = true;
  if (process_)
    process_->signal(SIGINT);
  else
    part_->state = deploy::part_state::ended;
}

void hosted_part::take_reports() {
  if (!part_->lives.empty())
    take_report(part_->lives.back()); // those before have ended, and were read then
}

void hosted_part::take_report(life& x) {
  std::error_code none;
  const auto written = fs::last_write_time(x.file, none);
  if (none || x.is_final || written == x.file_written)
    return;
  x.file_written = written;
  if (auto found = read_part_file(x.file.string())) {
    x.newest = std::move(found->newest);
    x.is_final = found->is_final;
    x.change = ++part_->changes;
  }
}

fs::path hosted_part::report_file(std::size_t number) const {
  return file('-' + std::to_string(number) + ".report");
}

/// For a service that takes the place of this one: which deployment the reports are of, and which
/// lives: number, elapsed and ended in nanoseconds.
void hosted_part::keep_lives() {
  std::string text = part_->id + '\n';
  for (const auto& each : part_->lives)
    text += std::to_string(each.number) + ' ' + std::to_string(each.elapsed.count()) + ' ' +
            std::to_string(each.ended.count()) + '\n';
  if (const auto why = io::replace_file(file(".lives").string(), text); !why.empty())
    note("cannot store the start count of its part: " + why);
}

/// What an earlier service of this host has left of the deployment that is offered; what it has
/// left of others is removed.
void hosted_part::take_over_lives() {
  std::ifstream in(file(".lives"));
  std::string deployment;
  std::getline(in, deployment);
  life x;
  duration::rep elapsed = 0;
  duration::rep ended = 0;
  for (std::size_t i = 1; i <= lives_max && in >> x.number >> elapsed >> ended; ++i) {
    x.file = report_file(i);
    x.elapsed = duration(elapsed);
    x.ended = duration(ended);
    if (deployment == part_->id) {
      take_report(part_->lives.emplace_back(x));
    } else {
      std::error_code ignored;
      fs::remove(x.file, ignored);
    }
  }
  if (deployment != part_->id)
    keep_lives();
}

deploy::news hosted_part::news_after(const deploy::ask_news& x) {
  deploy::news out;
  if (has(x.deployment)) {
    take_reports();
    auto page = part_->log.after(x.line);
    out.line = page.last;
    out.lines = std::move(page.lines);
    out.lines_left_out = page.left_out;
    out.change = part_->changes;
    for (const auto& each : part_->lives)
      if (each.change > x.change)
        out.lives.push_back({each.number, each.elapsed, each.ended, each.is_final, each.newest});
  }
  cut(out);
  out.facts = facts();
  return out;
}

/// Leaves the newest lives to the next answer if there are too many. Their changes ascend.
void hosted_part::cut(deploy::news& x) const {
  if (x.lives.size() <= lives_sent_max)
    return;
  x.lives.resize(lives_sent_max);
  x.has_more = true;
  x.change = std::ranges::find(part_->lives, x.lives.back().life, &life::number)->change;
}

std::optional<report::run_report> hosted_part::newest_report() {
  if (!part_ || part_->lives.empty())
    return std::nullopt;
  take_reports();
  const auto& newest = part_->lives.back().newest.report;
  return newest.ecology.empty() ? std::nullopt : std::optional(newest);
}

deploy::host_facts hosted_part::facts() const {
  deploy::host_facts out;
  out.host = with_.host;
  out.clock_us = io::system_clock_us();
  if (!part_)
    return out;
  out.state = part_->state;
  out.deployment = part_->id;
  out.ecology = part_->ecology.name;
  out.files_hash = part_->files_hash;
  out.seed = part_->what.seed;
  out.length = part_->what.length;
  out.refused = part_->refused;
  out.lives = static_cast<std::uint32_t>(part_->lives.size());
  if (part_->state != deploy::part_state::offered)
    out.elapsed = std::min<duration>(elapsed(), part_->what.length);
  if (process_)
    out.memory = memory_of(process_->pid());
  return out;
}

} // namespace rubicon::cli
