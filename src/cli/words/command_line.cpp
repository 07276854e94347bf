#include "cli/words/command_line.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <sstream>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>

#include "cli/ecology_file.hpp"
#include "cli/words/add_option.hpp"
#include "cli/words/certs_command_line.hpp"
#include "cli/words/network_command_line.hpp"
#include "cli/words/original_options.hpp"
#include "cli/words/serial_command_line.hpp"
#include "cli/words/version.hpp"
#include "config/load.hpp"
#include "config/toml/units.hpp"
#include "core/text/ipv4_network.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"
#include "core/text/spelling.hpp"

namespace rubicon::cli {

namespace {

constexpr const char* about =
    "Runs a robotic ecology: islands of wireless motes, their sinks, the gateways on basestation\n"
    "PCs, proxies, and PEIS peers, described by one TOML file.";

constexpr const char* roles =
    "Roles that the file can give this binary:\n"
    "  mote           a constrained node with a radio, transducers, actuators and programs\n"
    "  sink           the mote at the end of a basestation's serial cable\n"
    "  gateway        joins an island to the PEIS network, one per island\n"
    "  PEIS peer      a PC or robot with a PEIS kernel and its programs\n"
    "  proxy          represents one mote through tuples with meaning and units\n"
    "  proxy manager  starts and ends proxies as motes join and leave\n"
    "  init           starts, stops and watches the other components of its host\n"
    "\n"
    "Exit status: 0 success; 1 the run ended with violations, equal runs differed, no peer\n"
    "or host answered, or a certificate is invalid; 2 the command line or the file was rejected;\n"
    "130 Ctrl-C ended it.";

duration parse_length(const std::string& text, const char* option = "--for") {
  const auto length = config::parse_duration(text);
  if (!length || *length <= 0s)
    throw CLI::ValidationError(option, "not a length of time: '" + text + "' (say 90s or 10min)");
  return *length;
}

double parse_speed(const std::string& text) {
  double speed = 0;
  if (!CLI::detail::lexical_cast(text, speed) || !std::isfinite(speed) || speed <= 0)
    throw CLI::ValidationError("--speed", "not a positive number: '" + text + "'");
  return speed;
}

std::optional<std::uint64_t> parse_whole(std::string_view text) {
  std::uint64_t x = 0;
  const auto* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, x);
  return error == std::errc{} && stop == end ? std::optional(x) : std::nullopt;
}

std::uint64_t parse_seed(const std::string& text) {
  if (const auto seed = parse_whole(text))
    return *seed;
  throw CLI::ValidationError("--seed", "not a number from 0 to 2^64 - 1: '" + text + "'");
}

seed_range parse_seeds(const std::string& text) {
  const auto dots = text.find("..");
  const auto first = parse_whole(std::string_view(text).substr(0, dots));
  const auto last =
      dots == std::string::npos ? first : parse_whole(std::string_view(text).substr(dots + 2));
  if (!first || !last || *last < *first)
    throw CLI::ValidationError("--seeds", "not a range of seeds: '" + text + "' (say 1..100)");
  return {*first, *last};
}

std::uint64_t parse_jobs(const std::string& text) {
  const auto jobs = parse_whole(text);
  if (!jobs || *jobs < 1 || *jobs > 1024)
    throw CLI::ValidationError("--jobs", "not a number from 1 to 1024: '" + text + "'");
  return *jobs;
}

void add_file(CLI::App& app, std::string& file) {
  app.add_option("FILE", file, "The TOML file that describes the ecology; - reads standard input")
      ->required()
      ->type_name("");
}

void add_settings(CLI::App& app, config::settings& x) {
  app.add_option("--set", x,
                 "Set a key of the file, as in island.kitchen.id=3, with * for all tables; a name "
                 "alone is a parameter of the file; may be repeated")
      ->allow_extra_args(false)
      ->type_name("PATH=VALUE");
}

void add_overrides(CLI::App& app, config::overrides& x) {
  add_settings(app, x.settings);
  add_path(app, "--topology", "FILE", x.topology,
           "TOSSIM topology with gains, instead of the one that the TOML file names");
  add_path(app, "--noise-trace", "FILE", x.noise_trace,
           "Noise readings, instead of those that the TOML file names");
}

/// PORT or ADDRESS:PORT
void parse_page_place(const std::string& text, page_place& x) {
  const auto colon = text.rfind(':');
  const auto port = parse_whole(colon == std::string::npos ? text : text.substr(colon + 1));
  if (colon != std::string::npos)
    x.address = text.substr(0, colon);
  if (!parse_ipv4_address(x.address) || !port || *port > 65535)
    throw CLI::ValidationError("--view", "not a port, or an IPv4 address and a port: '" + text +
                                             "' (say 8080, or nothing for any)");
  x.port = static_cast<std::uint16_t>(*port);
}

CLI::Option* add_view(CLI::App& app, std::optional<page_place>& x) {
  return add_parsed(
             app, "--view", "PORT",
             "Show the run live in a browser: prints the address, and keeps serving until Ctrl-C",
             [&x](const auto& text) {
               x.emplace();
               if (!text.empty())
                 parse_page_place(text, *x);
             })
      ->expected(0, 1);
}

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

CLI::App& add_run(CLI::App& app, run_command& x) {
  auto& run = *app.add_subcommand("run", "Run an ecology to its end and report");
  auto& options = x.options;
  add_file(run, x.file);
  add_parsed(run, "--for", "TIME", "Ecology time to run, such as 90s, 10min or 24h",
             [&](const auto& text) { options.length = parse_length(text); });
  add_parsed(run, "--seed", "N", "Seed of all random numbers",
             [&](const auto& text) { options.seed = parse_seed(text); });
  add_parsed(run, "--mode", "MODE", "virtual (fast and repeatable) or wall (real time)",
             [&](const auto& text) {
               options.mode =
                   text == "wall" ? config::run_mode::wall : config::run_mode::virtual_time;
             })
      ->check(CLI::IsMember({"virtual", "wall"}));
  add_parsed(run, "--speed", "X", "Ecology seconds per real second",
             [&](const auto& text) { options.speed = parse_speed(text); });
  options.threads = std::max(1U, std::thread::hardware_concurrency());
  run.add_option("--threads", options.threads,
                 "Threads in virtual time; the result does not depend on it")
      ->check(CLI::Range(1U, 256U))
      ->type_name("N");
  auto* const json = run.add_flag("--json", x.json, "Print the report as one JSON object only");
  run.add_flag("--full", x.full, "Print every row of the report")->excludes(json);
  add_path(run, "--report", "FILE", x.watch.page_file,
           "Write the report as one self-contained HTML page");
  auto* const csv = add_path(run, "--csv", "DIR", x.watch.csv_folder,
                             "Write tuples, energy, links, losses and events over time as CSV");
  add_parsed(run, "--csv-every", "TIME",
             "Ecology time between two samples; default: a hundredth of the run, at least 1s",
             [&](const auto& text) { x.watch.csv_every = parse_length(text, "--csv-every"); })
      ->needs(csv);
  auto* const view = add_view(run, x.watch.view);
  add_control(run, x.watch,
              "Let the page cause faults and changes and set tuples, with =kernel also kernel.* "
              "tuples; in wall time")
      ->needs(view);
  run.add_option("--log", x.log_level, "Least level logged on standard error")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
      ->type_name("LEVEL");
  auto* const debug = add_path(run, "--debug-dir", "DIR", options.debug_folder,
                               "Write logs of all messages into this folder");
  run.add_option("--debug-of", options.debug_of,
                 "Only messages from or to these: a module such as mote, or a path in the logs "
                 "such as mote/kitchen; may be repeated")
      ->needs(debug)
      ->allow_extra_args(false)
      ->type_name("PATTERN");
  auto* const captures =
      add_path(run, "--pcap", "DIR", options.pcap_folder,
               "Write the frames of each radio medium into a capture in this folder");
  run.add_flag("--pcap-lost", options.pcap_lost,
               "Also capture frames that no radio received, as pcapng, with a comment that gives "
               "the reason")
      ->needs(captures);
  add_path(run, "--record-serial", "FILE", options.serial_file,
           "Write the frames on serial lines into this file, for `serial = { replay = FILE }`");
  add_path(run, "--record", "RECORD", options.record_file,
           "Record the run into this file, for rubicon explain");
  auto* const reload = run.add_flag(
      "--reload", x.reloads,
      "Read FILE again on SIGHUP, instead of ending, and apply what may change; in wall time");
  auto* const host =
      run.add_option(
             "--host", x.host,
             "Run only the part placed on this [[host]], in wall time, linked to the others")
          ->type_name("NAME")
          ->excludes(reload);
  add_path(run, "--starts", "FILE", x.starts_file,
           "File that counts the starts of the part; default: a file of the user")
      ->needs(host);
  // Options that a host gives to the parts that it starts.
  run.add_flag("--bundled", x.is_bundled, "FILE was written by a host")->group("");
  add_path(run, "--part-report", "FILE", x.part_file, "Where reports are written")
      ->needs(host)
      ->group("");
  add_parsed(run, "--elapsed", "TIME", "How long the other parts have run",
             [&](const auto& text) { x.elapsed = parse_length(text, "--elapsed"); })
      ->needs(host)
      ->group("");
  run.add_flag("--strict", x.is_strict, "Treat warnings about the file as errors");
  add_overrides(run, x.instead);
  run.add_flag("--check-determinism", x.check_determinism,
               "Run twice, the second time on one thread, and compare the trace hashes");
  run.footer(
      "Defaults come from the file; LEVEL is warn, N of --threads one per core.\n"
      "The options of an original PEIS kernel (--peis-id N, --peis-connect URL, ...) override\n"
      "the settings of the file's peer (docs/peis.md).\n"
      "In wall time events are printed on standard error as they happen, except with --log off.");
  return run;
}

void add_tls(CLI::App& app, control::tls_files& x) {
  auto* const certificate = add_path(app, "--tls-cert", "FILE", x.certificate,
                                     "Own certificate, made by `rubicon certs add`");
  auto* const key = add_path(app, "--tls-key", "FILE", x.key, "Its key");
  auto* const authority = add_path(
      app, "--tls-ca", "FILE", x.authority,
      "Certificate of the authority: only peers with certificates signed by it are accepted");
  certificate->needs(key)->needs(authority);
  key->needs(certificate);
  authority->needs(certificate);
}

/// ADDRESS:PORT or ADDRESS
void parse_listen(const std::string& text, host_command& x) {
  const auto colon = text.find(':');
  x.address = text.substr(0, colon);
  const auto port = colon == std::string::npos ? std::optional<std::uint64_t>(x.port)
                                               : parse_whole(text.substr(colon + 1));
  if (!parse_ipv4_address(x.address) || !port || *port > 65535)
    throw CLI::ValidationError("--listen", "not an IPv4 address and a port: '" + text +
                                               "' (say 192.168.1.5:4242)");
  x.port = static_cast<std::uint16_t>(*port);
}

CLI::App& add_host(CLI::App& app, host_command& x) {
  auto& host = *app.add_subcommand("host", "Be one of the computers that run an ecology together");
  host.add_option("--name", x.name, "Its name, as in [[host]] of the files")
      ->required()
      ->type_name("NAME");
  add_parsed(host, "--listen", "ADDRESS:PORT",
             "Address that accepts commands; default: 127.0.0.1:4242",
             [&](const auto& text) { parse_listen(text, x); });
  add_tls(host, x.tls);
  host.add_flag("--allow-commands", x.access.commands,
                "Let files start programs here, as commands of an init");
  host.add_option("--allow-devices", x.access.devices,
                  "Serial ports, pseudo-terminals and Bluetooth adapters that files may open here: "
                  "'/dev/ttyUSB*,hci0'")
      ->delimiter(',')
      ->type_name("PATH");
  add_path(host, "--state", "DIR", x.state_folder,
           "Folder for files and start counts; default: a folder of the user");
  add_path(host, "--files", "DIR", x.files_folder,
           "Folder where recorders of the file write; default: NAME-files in that folder");
  host.footer("It runs until Ctrl-C or SIGTERM, which also ends its part of the ecology.\n"
              "Without certificates it accepts commands from this computer only.");
  return host;
}

CLI::App& add_doctor(CLI::App& app, doctor_command& x) {
  auto& doctor = *app.add_subcommand(
      "doctor", "Check this computer and the hosts of a file, and suggest fixes");
  doctor.add_option("FILE", x.file, "File whose [[host]]s are checked as well")->type_name("");
  add_tls(doctor, x.tls);
  doctor.add_flag("--json", x.json, "Print JSON only");
  return doctor;
}

/// `rubicon status`, `stop` and `fault`.
class deployed_command_line {
public:
  explicit deployed_command_line(CLI::App& app)
      : status_(add(app, "status", "Show the state of a deployment, host by host")),
        stop_(add(app, "stop", "End a deployment, on all its hosts")),
        fault_(add(app, "fault", "Cause a fault or a change in a deployment now")) {
    status_.add_flag("--json", asked_.json, "Print one JSON object only");
    fault_.add_option("SENTENCE", cause_.sentence, "Such as \"crash mote kitchen/stove for 10s\"")
        ->required()
        ->type_name("");
    fault_.footer("SENTENCE is a kind of [[fault]] or [[change]], then its keys and values.");
  }

  [[nodiscard]] std::optional<deployed_command> parsed() const {
    if (status_.parsed())
      return deployed_command{ecology_, asked_};
    if (stop_.parsed())
      return deployed_command{ecology_, stop_all{}};
    if (fault_.parsed())
      return deployed_command{ecology_, cause_};
    return std::nullopt;
  }

private:
  CLI::App& add(CLI::App& app, const char* name, const char* text) {
    auto& out = *app.add_subcommand(name, text);
    out.add_option("--ecology", ecology_, "Its name; default: the one you deployed last")
        ->type_name("NAME");
    return out;
  }

  std::string ecology_;
  ask_status asked_;
  fault_now cause_;
  CLI::App& status_;
  CLI::App& stop_;
  CLI::App& fault_;
};

CLI::App& add_deploy(CLI::App& app, deploy_command& x) {
  auto& deploy = *app.add_subcommand("deploy", "Run an ecology on the hosts of its file, as one");
  add_file(deploy, x.file);
  deploy.add_flag("--local", x.local, "Run every [[host]] as a process of this computer");
  deploy.add_flag("--dry-run", x.dry_run, "Only print what would run where, and whether it can");
  deploy.add_flag("--attach", x.attach, "Follow a running deployment, in place of its coordinator")
      ->excludes("--local")
      ->excludes("--dry-run");
  add_tls(deploy, x.tls);
  add_parsed(deploy, "--for", "TIME", "Time to run, such as 90s, 10min or 24h",
             [&](const auto& text) { x.length = parse_length(text); });
  add_parsed(deploy, "--seed", "N", "Seed of all random numbers",
             [&](const auto& text) { x.seed = parse_seed(text); });
  auto* const json = deploy.add_flag("--json", x.json, "Print the report as one JSON object only");
  deploy.add_flag("--full", x.full, "Print every row of the report")->excludes(json);
  add_path(deploy, "--report", "FILE", x.page_file,
           "Write the report as one self-contained HTML page");
  auto* const view = add_view(deploy, x.view);
  deploy.add_flag("--control", x.control, "Let the page cause faults")->needs(view);
  deploy.add_option("--log", x.log_level, "Least level logged on standard error")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
      ->type_name("LEVEL");
  deploy.footer("Each host already runs `rubicon host`; with --local the hosts are started here.\n"
                "A part that was killed is restarted, as its next life.\n"
                "Ctrl-C stops all hosts and reports the run so far, with status 130.");
  return deploy;
}

CLI::App& add_swarm(CLI::App& app, swarm_command& x) {
  auto& swarm = *app.add_subcommand("swarm", "Run an ecology once per seed, in virtual time");
  add_file(swarm, x.file);
  add_parsed(swarm, "--seeds", "A..B", "The seeds, both ends included", [&](const auto& text) {
    x.seeds = parse_seeds(text);
  })->required();
  auto* const jobs =
      add_parsed(swarm, "--jobs", "N", "Number of parallel runs; default: one per core",
                 [&](const auto& text) { x.jobs = parse_jobs(text); });
  add_parsed(swarm, "--for", "TIME", "Ecology time of each run; default: the file's",
             [&](const auto& text) {
               static_cast<void>(parse_length(text));
               x.length = text;
             });
  add_parsed(swarm, "--timeout", "TIME", "Real time after which a run is aborted; default: 5min",
             [&](const auto& text) { x.timeout = parse_length(text, "--timeout"); });
  add_settings(swarm, x.settings);
  swarm.add_flag("--json", x.json, "Print one JSON object only");
  add_path(swarm, "--report", "FILE", x.page_file,
           "Write the results, and how they differ between seeds, as one HTML page");
  auto* const hosts =
      swarm
          .add_option("--hosts", x.hosts,
                      "Computers that run them, each with `rubicon host`: names of [[host]] of the "
                      "file or ADDRESS:PORT, separated by commas; default: this computer")
          ->delimiter(',')
          ->type_name("NAMES");
  jobs->excludes(hosts);
  add_tls(swarm, x.tls);
  swarm.footer("Ctrl-C ends it with the results so far, and status 130.");
  return swarm;
}

void parse_variations(const std::vector<std::string>& texts, std::vector<study::variation>& out) {
  for (const auto& text : texts) {
    auto found = study::parse_variation(text);
    if (const auto* why = std::get_if<std::string>(&found))
      throw CLI::ValidationError("--vary", "'" + text + "' " + *why);
    out.push_back(std::get<study::variation>(std::move(found)));
  }
}

CLI::App& add_sweep(CLI::App& app, sweep_command& x) {
  auto& sweep = *app.add_subcommand(
      "sweep", "Run an ecology with all combinations of some values, and keep what they give");
  add_file(sweep, x.file);
  sweep
      .add_option_function<std::vector<std::string>>(
          "--vary", [&x](const auto& all) { parse_variations(all, x.variations); },
          "A key or parameter, as of --set, and its values: a list as in loss=0,0.1,0.2, or a "
          "range "
          "with its step as in range=15m..40m/5; may be repeated")
      ->allow_extra_args(false)
      ->type_name("PATH=VALUES")
      ->required();
  add_parsed(sweep, "--seeds", "A..B", "The seeds of each variant, both ends included",
             [&](const auto& text) { x.seeds = parse_seeds(text); })
      ->required();
  add_path(sweep, "--out", "DATABASE", x.database,
           "SQLite database of the results; runs that it has are not repeated")
      ->required();
  add_settings(sweep, x.settings);
  add_parsed(sweep, "--jobs", "N", "Number of parallel runs; default: one per core",
             [&](const auto& text) { x.jobs = parse_jobs(text); });
  add_parsed(sweep, "--for", "TIME", "Ecology time of each run; default: the file's",
             [&](const auto& text) {
               static_cast<void>(parse_length(text));
               x.length = text;
             });
  add_parsed(sweep, "--timeout", "TIME", "Real time after which a run is aborted; default: 5min",
             [&](const auto& text) { x.timeout = parse_length(text, "--timeout"); });
  sweep
      .add_option("--of", x.scalars,
                  "Number of the report that the summary shows, such as messages.delivery; may be "
                  "repeated")
      ->allow_extra_args(false)
      ->type_name("SCALAR");
  sweep.add_flag("--csv", x.csv, "Print the summary as CSV");
  sweep.footer("Ctrl-C ends it with status 130; runs that have ended are in the database.");
  return sweep;
}

CLI::App& add_query(CLI::App& app, query_command& x) {
  auto& query = *app.add_subcommand("query", "Ask the database of a sweep");
  query.add_option("DATABASE", x.database, "As `rubicon sweep` has made it")
      ->required()
      ->type_name("");
  query.add_option("SQL", x.sql, "A SELECT of SQLite")->required()->type_name("");
  query.add_flag("--csv", x.csv, "Print the rows as CSV");
  return query;
}

CLI::App& add_explain(CLI::App& app, explain_command& x) {
  auto& explain = *app.add_subcommand("explain", "Trace a message or a value in a recorded run");
  explain.add_option("RECORD", x.record, "File written by run --record")->required()->type_name("");
  explain
      .add_option("WHAT", x.what,
                  "A message such as kitchen/fan#3, or a tuple such as kitchen.fan.state")
      ->type_name("");
  add_parsed(explain, "--at", "TIME", "The value of the tuple at this time, not the newest",
             [&](const auto& text) { x.at = parse_length(text, "--at"); });
  explain.add_flag("--all", x.all, "All values of the tuple, one per line");
  explain.add_flag("--lost", x.list.lost_only, "Only messages that were lost");
  explain.add_option("--from", x.list.from, "Only messages from this mote, island or PC")
      ->type_name("WHO");
  add_parsed(explain, "--limit", "N", "Only the newest N; 0 for all; default: 20",
             [&](const auto& text) {
               const auto limit = parse_whole(text);
               if (!limit)
                 throw CLI::ValidationError("--limit", "not a number: '" + text + "'");
               x.list.limit = *limit;
             });
  explain.add_flag("--json", x.json, "Print JSON only");
  explain.footer("Without WHAT it lists the messages with their outcomes, and the tuples.");
  return explain;
}

CLI::App& add_view(CLI::App& app, view_command& x) {
  auto& view = *app.add_subcommand("view", "Show any moment of a recorded run in a browser");
  view.add_option("RECORD", x.record, "File written by run --record")->required()->type_name("");
  add_parsed(view, "--port", "PORT", "Address of the page; default: any free port of 127.0.0.1",
             [&](const auto& text) { parse_page_place(text, x.where); });
  view.footer("It prints the address of the page, and keeps serving until Ctrl-C.");
  return view;
}

/// Options of `run` with their values, as a shell takes them.
std::string repeated_options(const CLI::App& run) {
  std::string text;
  const auto& left_out = options_not_repeated();
  for (const auto* option : run.get_options()) {
    if (option->count() == 0 || option->get_lnames().empty())
      continue;
    const auto name = "--" + option->get_lnames().front();
    if (std::ranges::find(left_out, name) != left_out.end())
      continue;
    const bool is_flag = option->get_items_expected_max() == 0;
    for (const auto& value : option->results())
      text += (text.empty() ? "" : " ") + name + (is_flag ? "" : ' ' + shell_word(value));
  }
  return text;
}

void check_combination(const explain_command& x) {
  if (x.what.empty() && (x.at || x.all))
    throw CLI::ValidationError(x.at ? "--at" : "--all", "of which tuple?");
  if (x.at && x.all)
    throw CLI::ValidationError("--at", "selects one time, --all selects all");
  if (!x.what.empty() && (x.list.lost_only || !x.list.from.empty()))
    throw CLI::ValidationError(x.list.lost_only ? "--lost" : "--from",
                               "filters the list, which is printed only without WHAT");
}

void check_combination(const run_command& x) {
  if (x.check_determinism && x.options.mode == config::run_mode::wall)
    throw CLI::ValidationError("--check-determinism",
                               "only virtual runs are reproducible, not --mode wall");
  if (x.check_determinism && !x.options.record_file.empty())
    throw CLI::ValidationError("--check-determinism", "runs twice, --record records one run");
  if (x.check_determinism && !x.options.serial_file.empty())
    throw CLI::ValidationError("--check-determinism",
                               "runs twice, --record-serial records one run");
  if (x.check_determinism && !(x.watch.page_file + x.watch.csv_folder).empty())
    throw CLI::ValidationError("--check-determinism",
                               "runs twice, --report and --csv describe one run");
  if (x.check_determinism && x.watch.view)
    throw CLI::ValidationError("--check-determinism", "runs twice, --view shows one run");
  if (!x.part_file.empty() && x.watch.view)
    throw CLI::ValidationError("--view", "the page of a deployment shows all parts");
  if (!x.host.empty() && x.check_determinism)
    throw CLI::ValidationError("--check-determinism",
                               "only virtual runs are reproducible, not --host");
  if (!x.host.empty() && x.options.mode == config::run_mode::virtual_time)
    throw CLI::ValidationError("--host",
                               "its part is linked to those of other hosts: in wall time only");
}

void check_combination(const deploy_command& x) {
  if (x.file == standard_input)
    throw CLI::ValidationError("FILE",
                               "it is sent with the files that it names: not from standard input");
}

void check_combination(const sweep_command& x) {
  if (x.file == standard_input)
    throw CLI::ValidationError("FILE", "each run reads it again: not from standard input");
  if (x.seeds.last > INT64_MAX)
    throw CLI::ValidationError("--seeds", "a database holds seeds up to 2^63 - 1");
  const auto variants = study::variants_of(x.variations);
  if (const auto* why = std::get_if<std::string>(&variants))
    throw CLI::ValidationError("--vary", *why);
}

void check_combination(const swarm_command& x) {
  if (x.file == standard_input)
    throw CLI::ValidationError("FILE", "each run reads it again: not from standard input");
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* option : app.get_options())
    for (const auto& name : option->get_lnames())
      names.push_back("--" + name);
  return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* command : app.get_subcommands({}))
    names.push_back(command->get_name());
  return names;
}

/// What a refused line has that is no command or option; empty if there is no such word.
std::string unknown_word(const CLI::App& app, std::span<const char* const> arguments) {
  const auto* at = &app;
  for (const std::string argument : arguments.subspan(1)) {
    const auto word = argument.substr(0, argument.find('='));
    const auto commands = command_names(*at);
    if (word.starts_with("--")) {
      const auto options = option_names(*at);
      if (std::ranges::find(options, word) == options.end())
        return "there is no option `" + word + '`' + suggestion(word, options);
    } else if (std::ranges::find(commands, word) != commands.end()) {
      at = at->get_subcommands([&](const auto* x) { return x->get_name() == word; }).front();
    } else if (!commands.empty() && !word.starts_with('-')) {
      return "there is no command `" + word + '`' + suggestion(word, commands);
    }
  }
  return {};
}

/// The command that a refused line begins with, `tuples set `: its help is worth reading.
std::string command_meant(const CLI::App& app, std::span<const char* const> arguments) {
  std::string words;
  const auto* at = &app;
  for (const std::string word : arguments.subspan(1)) {
    const auto found = at->get_subcommands([&](const auto* x) { return x->get_name() == word; });
    if (found.empty())
      break;
    at = found.front();
    words += word + ' ';
  }
  return words;
}

/// What is printed of a refused line.
std::string refusal(const CLI::App& app, std::span<const char* const> arguments,
                    const std::string& why) {
  return "rubicon: " + printable(why) + "\nSee rubicon " + command_meant(app, arguments) +
         "--help.\n";
}

/// `help run` as `run --help`, and no word at all as `--help`.
void take_help(std::vector<std::string>& words) {
  if (words.size() == 1)
    words.emplace_back("--help");
  if (words.size() > 1 && words[1] == "help" && words.back() != "--help") {
    words.erase(words.begin() + 1);
    words.emplace_back("--help");
  }
}

} // namespace

const std::vector<std::string>& options_not_repeated() {
  static const std::vector<std::string> names{
      "--help",
      "--for",
      "--seed", // said anew
      "--threads",
      "--json",
      "--full",
      "--report",
      "--csv",
      "--csv-every",
      "--view",
      "--control",
      "--strict",
      "--log",
      "--debug-dir",
      "--debug-of",
      "--pcap",
      "--pcap-lost",
      "--record-serial",
      "--record",
      "--check-determinism",
      "--reload", // looking, and what a hand does
      "--bundled",
      "--part-report"}; // between a host and the parts that it starts
  return names;
}

namespace {

constexpr std::size_t options_octets_max = 65'536;

/// Commands that join a network have options of their own for the original ones.
std::vector<std::string> options_of_member(const original_options& x) {
  std::vector<std::string> words;
  if (!x.connect.empty())
    words.insert(words.end(),
                 {"--connect", x.connect.front().substr(x.connect.front().find("://") + 3)});
  if (x.network)
    words.insert(words.end(), {"--network", *x.network});
  if (x.id)
    words.insert(words.end(), {"--id", std::to_string(x.id->value)});
  return words;
}

command parse_words(std::span<const char* const> arguments, const original_options& original);

} // namespace

command parse_command_line(std::span<const char* const> arguments) {
  std::vector<std::string> words(arguments.begin(), arguments.end());
  const auto taken = take_original_options(
      words, [](const auto& file) { return config::read_file(file, options_octets_max).text; });
  if (const auto* why = std::get_if<std::string>(&taken))
    return refused_command{printable(*why) + '\n'};
  const auto& original = std::get<original_options>(taken);
  take_help(words);
  const auto name = words.size() > 1 ? words[1] : std::string();
  constexpr std::string_view members[] = {"top", "hosts", "tuples", "route", "ping"};
  if (std::ranges::find(members, name) != std::end(members))
    std::ranges::move(options_of_member(original), std::back_inserter(words));
  else if (!original.said.empty() && name != "run")
    return refused_command{
        "options of --peis- are for `run` and for commands that join a network\n"};
  std::vector<const char*> rest;
  for (const auto& word : words)
    rest.push_back(word.c_str());
  return parse_words(rest, original);
}

namespace {

command parse_words(std::span<const char* const> arguments, const original_options& original) {
  CLI::App app(about, "rubicon");
  app.set_version_flag("--version", std::string("rubicon ") + version);
  app.require_subcommand(1);
  app.failure_message([&](const CLI::App*, const CLI::Error& error) {
    const auto unknown = unknown_word(app, arguments);
    return refusal(app, arguments, unknown.empty() ? error.what() : unknown);
  });
  run_command run;
  run.options.handle_signals = true;
  const auto& run_app = add_run(app, run);
  check_command check;
  auto& check_app =
      *app.add_subcommand("check", "Check a file without running it, and summarise it");
  add_file(check_app, check.file);
  check_app.add_flag("--list", check.list, "List motes, peers and tuple keys instead");
  check_app.add_flag("--strict", check.is_strict, "Treat warnings about the file as errors");
  add_overrides(check_app, check.instead);
  schema_command schema;
  auto& schema_app = *app.add_subcommand(
      "schema", "Print the JSON Schema of these files, for editors and validators");
  schema_app.add_option("--tables", schema.tables_of)->group(""); // of docs/configuration.md
  deploy_command deploy;
  const auto& deploy_app = add_deploy(app, deploy);
  swarm_command swarm;
  host_command host;
  const auto& host_app = add_host(app, host);
  const deployed_command_line running(app);
  doctor_command doctor;
  const auto& doctor_app = add_doctor(app, doctor);
  const auto& swarm_app = add_swarm(app, swarm);
  sweep_command sweep;
  const auto& sweep_app = add_sweep(app, sweep);
  query_command query;
  const auto& query_app = add_query(app, query);
  explain_command explain;
  const auto& explain_app = add_explain(app, explain);
  view_command view;
  const auto& view_app = add_view(app, view);
  const certs_command_line certs(app);
  const serial_command_line serial(app);
  const network_command_line network(app);
  std::vector<std::string> of; // take_help() has taken them
  app.add_subcommand("help", "Show the help of a command")
      ->add_option("COMMAND", of, "Its words, as in tuples set; default: this overview")
      ->type_name("");
  app.footer(roles); // last: subcommands would inherit it
  try {
    app.parse(static_cast<int>(arguments.size()), arguments.data());
    check_combination(run);
    check_combination(explain);
    check_combination(deploy);
    check_combination(swarm);
    check_combination(sweep);
    if (!run.host.empty())
      run.options.mode = config::run_mode::wall;
    run.instead.seed = run.options.seed;
    run.instead.mode = run.options.mode;
    run.deciding = repeated_options(run_app);
    run.original = original;
    for (const auto& word : original.said)
      run.deciding += (run.deciding.empty() ? "" : " ") + shell_word(word);
  } catch (const CLI::ParseError& error) {
    const auto unknown = unknown_word(app, arguments);
    if (error.get_exit_code() == 0 && !unknown.empty()) // `help` of what is not there
      return refused_command{refusal(app, arguments, unknown)};
    std::ostringstream out;
    std::ostringstream err;
    if (app.exit(error, out, err) == 0)
      return show_command{out.str()};
    return refused_command{err.str()};
  }
  if (check_app.parsed())
    return check;
  if (schema_app.parsed())
    return schema;
  if (deploy_app.parsed())
    return deploy;
  if (host_app.parsed())
    return host;
  if (doctor_app.parsed())
    return doctor;
  if (auto asked = running.parsed())
    return *std::move(asked);
  if (swarm_app.parsed())
    return swarm;
  if (sweep_app.parsed())
    return sweep;
  if (query_app.parsed())
    return query;
  if (explain_app.parsed())
    return explain;
  if (view_app.parsed())
    return view;
  if (auto asked = certs.parsed())
    return *std::move(asked);
  if (auto asked = serial.parsed())
    return *std::move(asked);
  if (auto asked = network.parsed()) {
    asked->with.without_effect = original.without_effect;
    return *std::move(asked);
  }
  return run;
}

} // namespace

} // namespace rubicon::cli
