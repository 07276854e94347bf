#include "actors/run/ecology_run.hpp"

#include <chrono>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "actors/run/one_run.hpp"
#include "actors/run/run_files.hpp"
#include "core/text/shell_word.hpp"
#include "io/process/large_pages.hpp"
#include "report/expect/expectations.hpp"
#include "report/invariants.hpp"

namespace rubicon {

namespace {

using steady = std::chrono::steady_clock;

/// What the run is to do, the command line's word before the file's.
config::ecology_description overridden(config::ecology_description x, const run_options& options) {
  x.seed = options.seed.value_or(x.seed);
  x.mode = options.mode.value_or(x.mode);
  x.length = options.length.value_or(x.length);
  return x;
}

/// What is known before anything has run: nothing that anybody could take for a good end.
report::run_report empty_report(const config::ecology_description& x) {
  report::run_report report;
  report.ecology = x.name;
  report.seed = x.seed;
  report.mode = mode_name(x);
  report.reason = "the run was aborted";
  return report;
}

/// `rubicon run home.toml --seed 7 --for 20s --record run.rec && rubicon explain run.rec --lost`
std::string command_for(const report::expectation_report& x, const report::run_report& report,
                        const run_options& options, const std::string& host) {
  const auto file = options.source.file.empty() ? "FILE" : shell_word(options.source.file);
  const auto& given = options.source.options;
  auto text = "rubicon run " + file + shell_words(given);
  if (given.empty() && !host.empty())
    text += " --host " + shell_word(host);
  text += " --seed " + std::to_string(report.seed);
  if (x.at < instant{} + report.simulated)
    text += " --for " + std::to_string(x.at.time_since_epoch() / 1ms + 1) + "ms";
  else if (options.length)
    text += " --for " + std::to_string(*options.length / 1ms) + "ms";
  if (x.explain.empty())
    return text + " --log info";
  text += " --record run.rec && rubicon explain run.rec";
  return text + shell_words(x.explain);
}

void judge_run(report::run_report& report, const report::expectations& judge,
               const run_options& options, const std::string& host) {
  report.expectations = judge.judge(report);
  for (auto& each : report.expectations) {
    if (each.outcome != report::expectation_report::verdict::unmet)
      continue;
    each.command = command_for(each, report, options, host);
    report.violations.push_back(report::violation_of(each));
  }
}

/// Of its motes, the actors of the rest are few.
void expect_memory_of(const config::ecology_description& x) {
  constexpr std::size_t mote_octets = std::size_t{32} << 10U; // resident, of a mote that has joined
  std::size_t motes = 0;
  for (const auto& island : x.islands)
    motes += island.motes.size();
  io::expect_memory(motes * mote_octets);
}

} // namespace

/// Members are in the order in which they need each other.
class ecology_run::parts {
public:
  parts(config::ecology_description file, run_options options)
      : options_(std::move(options)), description_(overridden(std::move(file), options_)),
        judge_(description_.expectations, description_.length),
        files_(description_, options_, judge_), report_(empty_report(description_)) {
    expect_memory_of(description_);
    attempt([this] { run_.emplace(description_, options_, files_, judge_, report_); });
    for (auto& island : description_.islands)
      island.motes = std::vector<config::mote_description>(); // the ecology's actor has them
  }

  one_run& run() {
    if (!run_)
      throw std::runtime_error(report_.reason);
    if (!run_->ended_early().empty())
      throw std::runtime_error(run_->ended_early());
    return *run_;
  }

  report::run_report finish() {
    if (run_)
      attempt([this] {
        run_->perform();
        run_->measure();
      });
    run_.reset();
    const auto at_end = instant() + report_.simulated;
    for (auto& missing : files_.finish())
      report_.violations.push_back({at_end, report::requests_are_met, std::move(missing)});
    if (!report_.complete)
      report_.violations.push_back({at_end, report::run_is_complete, report_.reason});
    judge_run(report_, judge_, options_, description_.part ? description_.part->host : "");
    report_.wall_s = std::chrono::duration<double>(steady::now() - started_).count();
    return std::move(report_);
  }

private:
  /// Does it, whatever happens.
  template <class Action>
  void attempt(Action action) {
    const auto break_off = [this](const std::string& why) {
      report_.complete = false;
      report_.reason = why;
    };
    try {
      action();
    } catch (const std::bad_alloc&) {
      break_off("out of memory");
    } catch (const std::exception& error) {
      break_off(error.what());
    }
  }

  const steady::time_point started_ = steady::now();
  const run_options options_;
  config::ecology_description description_; ///< once the run has begun without its motes
  report::expectations judge_;
  run_files files_;
  report::run_report report_;
  std::optional<one_run> run_;
};

ecology_run::ecology_run(config::ecology_description description, run_options options)
    : parts_(std::make_unique<parts>(std::move(description), std::move(options))) {}
ecology_run::~ecology_run() = default;
ecology_run::ecology_run(ecology_run&&) noexcept = default;
ecology_run& ecology_run::operator=(ecology_run&&) noexcept = default;

scheduler::world& ecology_run::world() {
  return parts_->run().world();
}

const root_actor& ecology_run::root() {
  return parts_->run().root();
}

void ecology_run::plan(const config::fault_description& x, const std::vector<duration>& times) {
  parts_->run().plan(x, times);
}

void ecology_run::run_until(instant end) {
  parts_->run().run_until(end);
}

report::run_report ecology_run::report_so_far() {
  return parts_->run().report_so_far();
}

report::run_report ecology_run::finish() {
  return parts_->finish();
}

report::run_report run_ecology(config::ecology_description file, const run_options& options) {
  return ecology_run(std::move(file), options).finish();
}

} // namespace rubicon
