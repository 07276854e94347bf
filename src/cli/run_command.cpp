#include "cli/run_command.hpp"

#include <chrono>
#include <utility>

#include "cli/console.hpp"
#include "cli/ecology_file.hpp"
#include "cli/logging.hpp"
#include "cli/progress_bar.hpp"
#include "core/hash.hpp"
#include "core/printable.hpp"
#include "report/figures.hpp"

namespace rubicon::cli {

namespace {

/// A run with a progress bar where there is somebody to see it.
report::run_report run_watched(config::ecology_description ecology, run_options options,
                               const console& errors) {
  const auto mode = options.mode.value_or(ecology.mode);
  if (!errors.is_terminal || mode != config::run_mode::virtual_time)
    return run_ecology(std::move(ecology), options);
  progress_bar bar(errors.width);
  const auto start = std::chrono::steady_clock::now();
  options.progress = [&](const run_progress& x) {
    const auto text = bar.update(std::chrono::steady_clock::now() - start, x.reached, x.end);
    if (!text.empty())
      static_cast<void>(print(stderr, text)); // a bar nobody can see is no failure
  };
  struct eraser {
    progress_bar* bar;
    ~eraser() { static_cast<void>(print(stderr, bar->finish())); } // also when the run throws
  } const at_end{&bar};
  return run_ecology(std::move(ecology), options);
}

exit_status status_of(const report::run_report& x) {
  if (x.interrupted)
    return exit_status::interrupted;
  return x.complete && x.violations.empty() ? exit_status::good : exit_status::violated;
}

exit_status report_run(const run_command& x, ecology_file file) {
  auto options = x.options;
  options.source = {x.file, to_hex(file.text_hash)};
  const auto report = run_watched(std::move(file.ecology), std::move(options), console_of(stderr));
  const auto output = console_of(stdout);
  const auto text = x.json ? to_json(report) : to_text(report, output.width, output.colour);
  return print(stdout, text) ? status_of(report) : exit_status::refused;
}

exit_status compare_runs(const run_command& x, const config::ecology_description& ecology) {
  if (x.options.mode.value_or(ecology.mode) != config::run_mode::virtual_time) {
    static_cast<void>(
        print(stderr, printable(x.file) + ": only virtual runs repeat; add --mode virtual\n"));
    return exit_status::refused;
  }
  const auto first = run_watched(ecology, x.options, console_of(stderr));
  auto on_one_thread = x.options;
  on_one_thread.threads = 1;
  const auto second =
      first.interrupted ? first : run_watched(ecology, on_one_thread, console_of(stderr));
  if (second.interrupted) {
    static_cast<void>(print(stderr, printable(x.file) + ": interrupted, nothing is compared\n"));
    return exit_status::interrupted;
  }
  const bool equal = first.trace_hash == second.trace_hash && first.events == second.events;
  const auto tell = [](const char* name, const report::run_report& run) {
    return std::string(name) + "  " + run.trace_hash + "  " + report::counted(run.events, "event") +
           ", " + report::counted(run.violations.size(), "violation") + '\n';
  };
  const auto text = tell("first run   ", first) + tell("second run  ", second) +
                    (equal ? "equal\n" : "the runs differ\n");
  const bool told =
      x.json ? print(stderr, text) && print(stdout, to_json(first)) : print(stdout, text);
  if (!told)
    return exit_status::refused;
  return equal ? status_of(first) : exit_status::violated;
}

} // namespace

exit_status perform(const run_command& x) {
  set_up_logging(x.log_level, console_of(stderr));
  auto file = load_or_complain(x.file, x.instead, x.known);
  if (!file)
    return exit_status::refused;
  return x.check_determinism ? compare_runs(x, file->ecology) : report_run(x, std::move(*file));
}

} // namespace rubicon::cli
