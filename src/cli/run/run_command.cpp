#include "cli/run/run_command.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <variant>

#include <unistd.h>

#include "actors/run/ecology_run.hpp"
#include "cli/chain.hpp"
#include "cli/ecology_file.hpp"
#include "cli/print/console.hpp"
#include "cli/print/event_lines.hpp"
#include "cli/print/local_time.hpp"
#include "cli/print/logging.hpp"
#include "cli/print/progress_bar.hpp"
#include "cli/print/report_output.hpp"
#include "cli/print/served_metrics.hpp"
#include "cli/run/bundle_file.hpp"
#include "cli/run/part_file.hpp"
#include "cli/run/reloader.hpp"
#include "cli/run/run_watch.hpp"
#include "cli/run/running_note.hpp"
#include "cli/run/steered_run.hpp"
#include "cli/run/viewed_run.hpp"
#include "cli/words/option_text.hpp"
#include "config/plan/debug_selection.hpp"
#include "config/plan/placement.hpp"
#include "config/toml/document.hpp"
#include "core/hash.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"
#include "core/text/spelling.hpp"
#include "deploy/fault_sentence.hpp"
#include "io/files/line_input.hpp"
#include "io/files/stored_number.hpp"
#include "io/files/unwaiting_output.hpp"
#include "io/process/machine.hpp"
#include "report/figures.hpp"
#include "report/print/metrics.hpp"

namespace rubicon::cli {

namespace {

/// A run in wall time, which takes long and is looked at meanwhile: its events are printed as
/// they happen.
report::run_report run_logged(config::ecology_description ecology, run_options options,
                              const console& errors) {
  live_log log(errors.is_terminal, errors.width);
  io::unwaiting_output out(STDERR_FILENO); // what nobody can see is no failure
  const auto real = [start = std::chrono::steady_clock::now()] {
    return std::chrono::steady_clock::now() - start;
  };
  const auto show = [&out](const std::string& text) {
    if (text.empty())
      return;
    if (const auto missed = out.missed(); missed > 0)
      out.write(report::counted(missed, "line") + " not shown: the terminal was too slow\n");
    out.write(text);
  };
  chain(options.on_event, [&](const report::logged_event& x) { show(log.add_event(real(), x)); });
  chain(options.progress,
        [&](const run_progress& x) { show(log.update(real(), x.reached, x.end, x.events)); });
  struct eraser {
    live_log& log;
    io::unwaiting_output& out;
    ~eraser() { // also when the run throws
      constexpr duration patience = 1s;
      out.write(log.finish());
      out.flush(patience);
    }
  } const at_end{log, out};
  return run_ecology(std::move(ecology), options);
}

/// A run with a progress bar where there is somebody to see it.
report::run_report run_watched(config::ecology_description ecology, run_options options,
                               const console& errors, bool logs_events) {
  const auto mode = options.mode.value_or(ecology.mode);
  if (mode == config::run_mode::wall && logs_events)
    return run_logged(std::move(ecology), std::move(options), errors);
  if (!errors.is_terminal || mode != config::run_mode::virtual_time)
    return run_ecology(std::move(ecology), options);
  progress_bar bar(errors.width);
  const auto start = std::chrono::steady_clock::now();
  chain(options.progress, [&](const run_progress& x) {
    const auto text = bar.update(std::chrono::steady_clock::now() - start, x.reached, x.end);
    if (!text.empty())
      static_cast<void>(print(stderr, text)); // a bar nobody can see is no failure
  });
  struct eraser {
    progress_bar* bar;
    ~eraser() { static_cast<void>(print(stderr, bar->finish())); } // also when the run throws
  } const at_end{&bar};
  return run_ecology(std::move(ecology), options);
}

/// `rubicon run home.toml --seed 7 --for 20s`
std::string command_of(const run_command& x, std::uint64_t seed) {
  if (x.file == standard_input)
    return {};
  auto text = "rubicon run " + shell_word(x.file) + shell_words(x.deciding);
  text += " --seed " + std::to_string(seed);
  if (x.options.length)
    text += " --for " + option_text(*x.options.length);
  return text;
}

std::string collected_now(std::optional<duration> took = std::nullopt) {
  return report::to_metrics(report::collection{io::system_clock_us(), took});
}

exit_status report_run(const run_command& x, ecology_file file) {
  auto options = x.options;
  const auto digest = to_hex(file.text_hash);
  options.source = {x.file, digest, x.deciding};
  run_watch watch(x.watch, file.ecology);
  watch.attach(options);
  std::optional<reloader> again;
  if (x.reloads) {
    again.emplace(config::read_file(x.file, config::file_octets_max).text.value_or(""), x.file,
                  x.instead, x.known);
    chain(options.on_begun, [&again](const run_control& run) { again->begin(run); });
    options.on_hangup = [&again] { again->read(); };
  }
  std::optional<served_metrics> metrics;
  if (x.watch.metrics) {
    metrics.emplace(*x.watch.metrics);
    options.report_every = served_metrics::collect_every;
    options.on_report = [&metrics](report::run_report so_far, duration took) {
      metrics->show(std::move(so_far), collected_now(took));
    };
  }
  std::optional<viewed_run> viewed;
  if (x.watch.view) {
    viewed.emplace(x, file.ecology, command_of(x, x.options.seed.value_or(file.ecology.seed)));
    viewed->attach(options, file.ecology);
  }
  const auto labels = file.ecology.labels;
  const auto varied = file.varied;
  auto report = run_watched(std::move(file.ecology), std::move(options), console_of(stderr),
                            x.log_level != "off");
  watch.finish(report, command_of(x, report.seed), digest);
  const auto status = print_report(report, {x.json, x.full, x.brief}, labels, varied);
  if (metrics)
    metrics->show(report, collected_now()); // a page may keep the process
  if (viewed && !report.interrupted)
    viewed->finish(report);
  else if (!viewed && !x.json && console_of(stderr).is_terminal)
    static_cast<void>(print(stderr, "--view shows the run in a browser, at any moment\n"));
  return status;
}

exit_status compare_runs(const run_command& x, const config::ecology_description& ecology) {
  if (x.options.mode.value_or(ecology.mode) != config::run_mode::virtual_time) {
    static_cast<void>(print(
        stderr, printable(x.file) + ": only virtual runs are reproducible; add --mode virtual\n"));
    return exit_status::refused;
  }
  const auto first = run_watched(ecology, x.options, console_of(stderr), false);
  auto on_one_thread = x.options;
  on_one_thread.threads = 1;
  const auto second =
      first.interrupted ? first : run_watched(ecology, on_one_thread, console_of(stderr), false);
  if (second.interrupted) {
    static_cast<void>(print(stderr, printable(x.file) + ": interrupted, not compared\n"));
    return exit_status::interrupted;
  }
  const bool equal = first.trace_hash == second.trace_hash && first.events == second.events;
  const auto line_of = [](const char* name, const report::run_report& run) {
    return std::string(name) + "  " + run.trace_hash + "  " + report::counted(run.events, "event") +
           ", " + report::counted(run.violations.size(), "violation") + '\n';
  };
  const auto text = line_of("first run   ", first) + line_of("second run  ", second) +
                    (equal ? "equal\n" : "the runs differ\n");
  const bool is_printed =
      x.json ? print(stderr, text) && print(stdout, to_json(first)) : print(stdout, text);
  if (!is_printed)
    return exit_status::refused;
  return equal ? status_of(first) : exit_status::violated;
}

std::vector<std::string> host_names(const config::ecology_description& x) {
  std::vector<std::string> names;
  for (const auto& host : x.hosts)
    names.push_back(host.name);
  return names;
}

/// Puts the host's part in the place of all. @returns the problems that prevent it
std::vector<std::string> take_part(config::ecology_description& all, const std::string& host) {
  const auto used = config::used_hosts(all);
  const auto name_of = [](const auto& x) { return x.name; };
  if (config::find_host(all, host) == nullptr)
    return {"there is no [[host]] named `" + host + '`' + suggestion(host, host_names(all))};
  if (std::ranges::find(used, host, name_of) == used.end())
    return {"nothing is placed on host `" + host + '`'};
  auto problems = config::placement_problems(all);
  if (problems.empty())
    all = config::part_of(all, host);
  return problems;
}

/// Takes orders from the host that has started this part: `fault SENTENCE`.
std::unique_ptr<io::line_input> listen(const run_command& x, const run_control& run) {
  const auto cause = [known = x.known, file = x.file, run](const std::string& line) {
    constexpr std::string_view order = "fault ";
    const auto bundle = read_bundle(file);
    if (!line.starts_with(order) || !bundle)
      return;
    const auto sentence = line.substr(order.size());
    const auto found = deploy::fault_of(*bundle, sentence, known);
    if (const auto* fault = std::get_if<config::fault>(&found))
      run.apply(*fault);
    else
      static_cast<void>(print(
          stderr, printable("fault " + sentence + ": " + std::get<std::string>(found)) + '\n'));
  };
  return std::make_unique<io::line_input>(run.loop, cause);
}

/// Leaves reports where the deployment finds them, now and then and at the end: so what is lost
/// with a process that is killed is little.
exit_status run_for_deployment(const run_command& x, ecology_file file) {
  using steady = std::chrono::steady_clock;
  constexpr auto report_every = report::part_report_every;
  std::optional<ecology_run> run;
  report::part_report newest;
  const auto leave = [&](report::run_report so_far, bool is_final) {
    newest.report = std::move(so_far);
    const auto why = write_part_file(x.part_file, newest, is_final);
    if (!why.empty())
      static_cast<void>(print(stderr, printable(why) + '\n'));
    return why.empty();
  };
  auto options = x.options;
  options.source = {x.file, to_hex(file.text_hash), {}}; // whoever repeats it deploys anew
  std::unique_ptr<io::line_input> orders;
  options.on_begun = [&](const run_control& control) { orders = listen(x, control); };
  rate_limiter rate;
  const auto write = [](const std::string& text) {
    if (!text.empty())
      static_cast<void>(print(stdout, text));
  };
  const auto real = [start = steady::now()] { return steady::now() - start; };
  options.on_event = [&](const report::logged_event& event) {
    write(rate.left_out(real()));
    if (rate.take())
      write(event_line(event, x.elapsed) + '\n');
  };
  options.on_counters = [&newest](const report::run_counters& all) {
    newest.counters = all.unsettled();
  };
  options.progress = [&, next = steady::now() + report_every](const run_progress&) mutable {
    write(rate.left_out(real()));
    if (steady::now() < next)
      return;
    next = steady::now() + report_every;
    static_cast<void>(leave(run->report_so_far(), /*is_final=*/false));
  };
  run.emplace(std::move(file.ecology), std::move(options));
  auto whole = run->finish();
  write(rate.finish());
  const auto status = status_of(whole);
  return leave(std::move(whole), /*is_final=*/true) ? status : exit_status::failed;
}

/// A part of an ecology whose other parts know the lives that it has had.
exit_status run_part(run_command x, ecology_file file) {
  const auto refuse = [&x](const std::string& why) {
    static_cast<void>(print(stderr, printable(x.file + ": " + why) + '\n'));
    return exit_status::refused;
  };
  file.ecology.length = x.options.length.value_or(file.ecology.length);
  if (x.elapsed >= file.ecology.length)
    return refuse("the run ends after " + to_text(file.ecology.length));
  const auto problems = take_part(file.ecology, x.host);
  for (const auto& each : problems)
    static_cast<void>(refuse(each));
  if (!problems.empty())
    return exit_status::refused;
  if (x.starts_file.empty())
    x.starts_file = io::state_file(file.ecology.name + '-' + x.host + ".starts");
  if (x.starts_file.empty())
    return refuse("there is no folder to count the starts of the part in; use --starts FILE");
  auto opened = io::stored_number::open(x.starts_file);
  if (const auto* why = std::get_if<std::string>(&opened))
    return refuse(*why);
  auto& starts = std::get<io::stored_number>(opened);
  x.options.starts = starts.value();
  x.options.on_starts = [&starts](std::uint32_t most) {
    const auto why = starts.store(most);
    if (!why.empty())
      throw std::runtime_error(why); // others would take a later life for an earlier one
  };
  if (x.elapsed > 0s)
    config::begin_later(file.ecology, x.elapsed);
  const running_note note(file.ecology); // for commands that look into it
  x.options.length.reset();              // the description has it
  return x.part_file.empty() ? report_run(x, std::move(file))
                             : run_for_deployment(x, std::move(file));
}

/// For `start = "now"`: what the computer's clock shows, and will show for two years.
void take_clock(run_command& x) {
  constexpr duration day = 24h;
  const auto now = std::chrono::system_clock::now();
  x.instead.time_of_day = (time_of_day(now) + day - x.elapsed % day) % day;
  x.instead.clock_changes = clock_changes(now, 730 * day);
  for (auto& change : x.instead.clock_changes)
    change.at += x.elapsed;
}

/// Why nobody can do anything to a run; nullptr: somebody can.
const char* why_untouchable(const run_command& x, const ecology_file& file) {
  if (x.file == standard_input)
    return ": standard input can be read only once: give a file\n";
  if (x.options.mode.value_or(file.ecology.mode) != config::run_mode::wall)
    return ": a virtual run ends before you can act: add --mode wall\n";
  return nullptr;
}

} // namespace

exit_status perform(const run_command& wanted) {
  auto x = wanted;
  take_clock(x);
  set_up_logging(x.log_level, console_of(stderr));
  auto file = load_or_complain(x.file, x.instead, x.known, x.is_bundled);
  if (!file)
    return exit_status::refused;
  for (const auto& option : x.original.without_effect)
    static_cast<void>(print(stderr, printable(option) + " has no effect here\n"));
  if (const auto why = take_over(x.original, file->ecology); !why.empty()) {
    static_cast<void>(print(stderr, printable(why) + '\n'));
    return exit_status::refused;
  }
  if (x.is_strict && !file->warnings.empty()) {
    complain({std::nullopt, file->warnings}, x.file);
    return exit_status::refused;
  }
  if (!x.is_bundled) // whose sender has seen them
    warn(*file);
  if (const auto why = config::debug_names(file->ecology).problem(x.options.debug_of);
      !why.empty()) {
    static_cast<void>(print(stderr, printable("--debug-of: " + why) + '\n'));
    return exit_status::refused;
  }
  if (!x.host.empty())
    return run_part(x, std::move(*file));
  if (!x.steer.empty()) {
    if (x.options.mode.value_or(file->ecology.mode) == config::run_mode::virtual_time)
      return run_steered(x, std::move(*file));
    static_cast<void>(
        print(stderr, "--steer: time stands still between requests: add --mode virtual\n"));
    return exit_status::refused;
  }
  if (const auto* option = x.watch.control ? "--control" : x.reloads ? "--reload" : nullptr) {
    const auto* why = why_untouchable(x, *file);
    if (why != nullptr) {
      static_cast<void>(print(stderr, std::string(option) + why));
      return exit_status::refused;
    }
  }
  if (x.watch.metrics && x.options.mode.value_or(file->ecology.mode) != config::run_mode::wall) {
    static_cast<void>(print(
        stderr, "--metrics: a virtual run ends before anybody collects them: add --mode wall\n"));
    return exit_status::refused;
  }
  if (x.options.reseed && x.options.mode.value_or(file->ecology.mode) == config::run_mode::wall) {
    static_cast<void>(
        print(stderr, "--reseed: only virtual runs are reproducible; add --mode virtual\n"));
    return exit_status::refused;
  }
  std::optional<running_note> note; // for commands that look into it
  if (x.options.mode.value_or(file->ecology.mode) == config::run_mode::wall)
    note.emplace(file->ecology);
  return x.check_determinism ? compare_runs(x, file->ecology) : report_run(x, std::move(*file));
}

} // namespace rubicon::cli
