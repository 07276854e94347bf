#include "cli/options/run_command_line.hpp"

#include <algorithm>
#include <cassert>
#include <memory>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>

#include "cli/options/add_option.hpp"
#include "cli/options/option_values.hpp"

namespace rubicon::cli {

namespace {

/// `--control` or `--control=kernel`
CLI::Option* add_control(CLI::App& app, watch_options& x, const std::string& what) {
  const auto said = std::make_shared<std::string>();
  return app.add_flag("--control", *said, what)
      ->check(CLI::IsMember({"true", "kernel"}))
      ->each([&x, said](const std::string& text) {
        x.control = true;
        x.control_kernel = text == "kernel";
      });
}

/// Of a flag: no word behind it.
bool is_flag(const CLI::Option& x) {
  return x.get_items_expected_max() == 0;
}

} // namespace

run_command_line::run_command_line(CLI::App& app)
    : app_(*app.add_subcommand("run", "Run an ecology to its end and report")) {
  run_.options.handle_signals = true;
  run_.options.threads = std::max(1U, std::thread::hardware_concurrency());
  add_file(app_, run_.file);
  add_clock();
  add_report();
  add_page();
  add_metrics();
  add_logs();
  add_records();
  add_host();
  add_checks();
  assert(app_.get_options().size() == rows_ + 2); // beside --help and FILE
  app_.footer(
      "Defaults come from the file; LEVEL is warn, N of --threads one per core.\n"
      "The options of an original PEIS kernel (--peis-id N, --peis-connect URL, ...) override\n"
      "the settings of the file's peer (docs/peis.md).\n"
      "In wall time events are printed on standard error as they happen, except with --log off.");
  app_.final_callback([this] { check_combination(); });
}

CLI::Option* run_command_line::decides(CLI::Option* option) {
  deciding_.push_back(option);
  return shows(option);
}

CLI::Option* run_command_line::shows(CLI::Option* option) {
  ++rows_;
  return option;
}

void run_command_line::add_clock() {
  auto& options = run_.options;
  shows(add_parsed(app_, "--for", "TIME", "Ecology time to run, such as 90s, 10min or 24h",
                   [&](const auto& text) { options.length = parse_length(text); }));
  shows(add_parsed(app_, "--seed", "N", "Seed of all random numbers",
                   [&](const auto& text) { options.seed = parse_seed(text); }));
  decides(add_parsed(app_, "--mode", "MODE", "virtual (fast and repeatable) or wall (real time)",
                     [&](const auto& text) {
                       options.mode =
                           text == "wall" ? config::run_mode::wall : config::run_mode::virtual_time;
                     }))
      ->check(CLI::IsMember({"virtual", "wall"}));
  decides(add_parsed(app_, "--reseed", "TIME:K",
                     "Draw all random numbers after this time anew: another future for each K; "
                     "in virtual time",
                     [&](const auto& text) { options.reseed = parse_reseeding(text); }));
  decides(add_parsed(app_, "--speed", "X", "Ecology seconds per real second",
                     [&](const auto& text) { options.speed = parse_speed(text); }));
  shows(app_.add_option("--threads", options.threads,
                        "Threads in virtual time; the result does not depend on it"))
      ->check(CLI::Range(1U, 256U))
      ->type_name("N");
}

void run_command_line::add_report() {
  auto* const json =
      shows(app_.add_flag("--json", run_.json, "Print the report as one JSON object only"));
  auto* const full = shows(app_.add_flag("--full", run_.full, "Print every row of the report"));
  full->excludes(json);
  shows(app_.add_flag("--brief", run_.brief, "Print only the verdict and the expectations"))
      ->excludes(json)
      ->excludes(full);
  shows(add_path(app_, "--report", "FILE", run_.watch.page_file,
                 "Write the report as one self-contained HTML page"));
  auto* const csv =
      shows(add_path(app_, "--csv", "DIR", run_.watch.csv_folder,
                     "Write tuples, energy, links, losses and events over time as CSV"));
  shows(add_parsed(
            app_, "--csv-every", "TIME",
            "Ecology time between two samples; default: a hundredth of the run, at least 1s",
            [&](const auto& text) { run_.watch.csv_every = parse_length(text, "--csv-every"); }))
      ->needs(csv);
}

void run_command_line::add_page() {
  auto* const view = shows(cli::add_page(app_, run_.watch.view));
  shows(add_page_host(app_, [this] {
    return run_.watch.view ? &*run_.watch.view : nullptr;
  }))->needs(view);
  shows(add_control(
            app_, run_.watch,
            "Let the page cause faults and changes and set tuples, with =kernel also kernel.* "
            "tuples; in wall time"))
      ->needs(view);
}

void run_command_line::add_metrics() {
  for (auto* const each : cli::add_metrics(app_, run_.watch.metrics, "; in wall time"))
    shows(each);
}

void run_command_line::add_logs() {
  auto& options = run_.options;
  shows(add_log(app_, run_.log_level));
  auto* const debug = shows(add_path(app_, "--debug-dir", "DIR", options.debug_folder,
                                     "Write logs of all messages into this folder"));
  shows(app_.add_option("--debug-of", options.debug_of,
                        "Only messages from or to these: a module such as mote, or a path in the "
                        "logs such as mote/kitchen; may be repeated"))
      ->needs(debug)
      ->allow_extra_args(false)
      ->type_name("PATTERN");
  auto* const captures =
      shows(add_path(app_, "--pcap", "DIR", options.pcap_folder,
                     "Write the frames of each radio medium into a capture in this folder"));
  shows(app_.add_flag("--pcap-lost", options.pcap_lost,
                      "Also capture frames that no radio received, as pcapng, with a comment that "
                      "gives the reason"))
      ->needs(captures);
}

void run_command_line::add_records() {
  shows(add_path(app_, "--record-serial", "FILE", run_.options.serial_file,
                 "Write the frames on serial lines into this file, for `serial = { replay = FILE "
                 "}`"));
  shows(add_path(app_, "--record", "RECORD", run_.options.record_file,
                 "Record the run into this file, for rubicon explain"));
}

void run_command_line::add_host() {
  auto* const reload = shows(app_.add_flag(
      "--reload", run_.reloads,
      "Read FILE again on SIGHUP, instead of ending, and apply what may change; in wall time"));
  auto* const host =
      decides(app_.add_option(
                  "--host", run_.host,
                  "Run only the part placed on this [[host]], in wall time, linked to the others"))
          ->type_name("NAME")
          ->excludes(reload);
  decides(add_path(app_, "--starts", "FILE", run_.starts_file,
                   "File that counts the starts of the part; default: a file of the user"))
      ->needs(host);
  add_part(*host);
}

/// Options that a host gives to the parts that it starts.
void run_command_line::add_part(CLI::Option& host) {
  shows(app_.add_flag("--bundled", run_.is_bundled, "FILE was written by a host"))->group("");
  shows(add_path(app_, "--part-report", "FILE", run_.part_file, "Where reports are written"))
      ->needs(&host)
      ->group("");
  decides(add_parsed(app_, "--elapsed", "TIME", "How long the other parts have run",
                     [&](const auto& text) { run_.elapsed = parse_length(text, "--elapsed"); }))
      ->needs(&host)
      ->group("");
}

void run_command_line::add_checks() {
  shows(add_path(app_, "--steer", "SOCKET", run_.steer,
                 "Step and act as the program at this Unix socket requests, or the lines of this "
                 "file; in virtual time"));
  shows(app_.add_flag("--strict", run_.is_strict, "Treat warnings about the file as errors"));
  for (auto* const each : add_overrides(app_, run_.instead))
    decides(each);
  shows(app_.add_flag("--check-determinism", run_.check_determinism,
                      "Run twice, the second time on one thread, and compare the trace hashes"));
}

void run_command_line::check_combination() const {
  if (!run_.steer.empty())
    check_steer();
  if (run_.check_determinism)
    check_determinism();
  if (run_.watch.metrics && run_.check_determinism)
    throw CLI::ValidationError("--check-determinism", "runs twice, --metrics shows one run");
  if (!run_.part_file.empty() && run_.watch.view)
    throw CLI::ValidationError("--view", "the page of a deployment shows all parts");
  if (!run_.host.empty() && run_.check_determinism)
    throw CLI::ValidationError("--check-determinism",
                               "only virtual runs are reproducible, not --host");
  if (run_.options.reseed && !run_.host.empty())
    throw CLI::ValidationError("--reseed", "only virtual runs are reproducible, not --host");
  if (!run_.host.empty() && run_.options.mode == config::run_mode::virtual_time)
    throw CLI::ValidationError("--host",
                               "its part is linked to those of other hosts: in wall time only");
}

void run_command_line::check_steer() const {
  if (run_.options.mode == config::run_mode::wall || !run_.host.empty())
    throw CLI::ValidationError("--steer", "time stands still between requests: not in wall time");
  if (run_.file == "-")
    throw CLI::ValidationError("--steer", "standard input can be read only once: give a file");
  if (run_.check_determinism || run_.watch.view || run_.watch.metrics || run_.reloads ||
      !(run_.watch.page_file + run_.watch.csv_folder).empty())
    throw CLI::ValidationError("--steer", "cannot be combined with --check-determinism, --view, "
                                          "--metrics, --reload, --report and --csv");
}

void run_command_line::check_determinism() const {
  if (run_.options.mode == config::run_mode::wall)
    throw CLI::ValidationError("--check-determinism",
                               "only virtual runs are reproducible, not --mode wall");
  if (!run_.options.record_file.empty())
    throw CLI::ValidationError("--check-determinism", "runs twice, --record records one run");
  if (!run_.options.serial_file.empty())
    throw CLI::ValidationError("--check-determinism",
                               "runs twice, --record-serial records one run");
  if (!(run_.watch.page_file + run_.watch.csv_folder).empty())
    throw CLI::ValidationError("--check-determinism",
                               "runs twice, --report and --csv describe one run");
  if (run_.watch.view)
    throw CLI::ValidationError("--check-determinism", "runs twice, --view shows one run");
}

std::vector<std::string> run_command_line::repeated_options() const {
  std::vector<std::string> words;
  for (const auto* option : deciding_)
    for (const auto& value : option->results()) {
      words.push_back("--" + option->get_lnames().front());
      if (!is_flag(*option))
        words.push_back(value);
    }
  return words;
}

std::optional<run_command> run_command_line::parsed(const original_options& original) const {
  if (!app_.parsed())
    return std::nullopt;
  auto run = run_;
  if (!run.host.empty())
    run.options.mode = config::run_mode::wall;
  run.instead.seed = run.options.seed;
  run.instead.mode = run.options.mode;
  run.deciding = repeated_options();
  run.original = original;
  run.deciding.insert(run.deciding.end(), original.said.begin(), original.said.end());
  return run;
}

} // namespace rubicon::cli
