#include "cli/options/hosts_command_line.hpp"

#include <string>

#include <CLI/CLI.hpp>

#include "cli/ecology_file.hpp"
#include "cli/options/add_option.hpp"
#include "cli/options/option_values.hpp"
#include "core/text/ipv4_network.hpp"
#include "core/text/name.hpp"

namespace rubicon::cli {

namespace {

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

} // namespace

hosts_command_line::hosts_command_line(CLI::App& app)
    : deploy_app_(*app.add_subcommand("deploy", "Run an ecology on the hosts of its file, as one")),
      host_app_(
          *app.add_subcommand("host", "Be one of the computers that run an ecology together")),
      status_app_(*app.add_subcommand("status", "Show the state of a deployment, host by host")),
      stop_app_(*app.add_subcommand("stop", "End a deployment, on all its hosts")),
      fault_app_(*app.add_subcommand("fault", "Cause a fault or a change in a deployment now")),
      doctor_app_(*app.add_subcommand(
          "doctor", "Check this computer and the hosts of a file, and suggest fixes")),
      swarm_app_(*app.add_subcommand("swarm", "Run an ecology once per seed, in virtual time")) {
  add_deploy();
  add_host();
  add_deployed();
  add_doctor();
  add_swarm();
}

void hosts_command_line::add_host() {
  host_app_.add_option("--name", host_.name, "Its name, as in [[host]] of the files")
      ->required()
      ->check([](const std::string& x) {
        return is_name(x) ? std::string()
                          : "not a name of 1 to 32 letters, digits, - and _: '" + x + '\'';
      })
      ->type_name("NAME");
  add_parsed(host_app_, "--listen", "ADDRESS:PORT",
             "Address that accepts commands; default: 127.0.0.1:4242",
             [&](const auto& text) { parse_listen(text, host_); });
  add_tls(host_app_, host_.tls);
  host_app_.add_flag("--allow-commands", host_.access.commands,
                     "Let files start programs here, as commands of an init");
  host_app_.add_flag("--allow-firmware", host_.access.firmware,
                     "Let motes of files run firmware here: shared libraries that were sent");
  host_app_
      .add_option("--allow-devices", host_.access.devices,
                  "Serial ports, pseudo-terminals and Bluetooth adapters that files may open here: "
                  "'/dev/ttyUSB*,hci0'")
      ->delimiter(',')
      ->type_name("PATH");
  add_path(host_app_, "--state", "DIR", host_.state_folder,
           "Folder for files and start counts; default: a folder of the user");
  add_path(host_app_, "--files", "DIR", host_.files_folder,
           "Folder where recorders of the file write; default: NAME-files in that folder");
  add_metrics(host_app_, host_.metrics);
  host_app_.footer("It runs until Ctrl-C or SIGTERM, which also ends its part of the ecology.\n"
                   "Without certificates it accepts commands from this computer only.");
}

void hosts_command_line::add_deployed() {
  for (auto* const each : {&status_app_, &stop_app_, &fault_app_})
    each->add_option("--ecology", ecology_, "Its name; default: the one you deployed last")
        ->type_name("NAME");
  status_app_.add_flag("--json", status_.json, "Print one JSON object only");
  fault_app_
      .add_option("SENTENCE", fault_.sentence, "Such as \"crash mote kitchen/stove for 10s\"")
      ->required()
      ->type_name("");
  fault_app_.footer("SENTENCE is a kind of [[fault]] or [[change]], then its keys and values.");
}

void hosts_command_line::add_doctor() {
  doctor_app_.add_option("FILE", doctor_.file, "File whose [[host]]s are checked as well")
      ->type_name("");
  add_tls(doctor_app_, doctor_.tls);
  doctor_app_.add_flag("--json", doctor_.json, "Print JSON only");
}

void hosts_command_line::add_deploy() {
  add_file(deploy_app_, deploy_.file);
  deploy_app_.add_flag("--local", deploy_.local,
                       "Run every [[host]] as a process of this computer");
  deploy_app_.add_flag("--dry-run", deploy_.dry_run,
                       "Only print what would run where, and whether it can");
  deploy_app_
      .add_flag("--attach", deploy_.attach,
                "Follow a running deployment, in place of its coordinator")
      ->excludes("--local")
      ->excludes("--dry-run");
  add_tls(deploy_app_, deploy_.tls);
  add_parsed(deploy_app_, "--for", "TIME", "Time to run, such as 90s, 10min or 24h",
             [&](const auto& text) { deploy_.length = parse_length(text); });
  add_parsed(deploy_app_, "--seed", "N", "Seed of all random numbers",
             [&](const auto& text) { deploy_.seed = parse_seed(text); });
  auto* const json =
      deploy_app_.add_flag("--json", deploy_.json, "Print the report as one JSON object only");
  auto* const full = deploy_app_.add_flag("--full", deploy_.full, "Print every row of the report");
  full->excludes(json);
  deploy_app_.add_flag("--brief", deploy_.brief, "Print only the verdict and the expectations")
      ->excludes(json)
      ->excludes(full);
  add_path(deploy_app_, "--report", "FILE", deploy_.page_file,
           "Write the report as one self-contained HTML page");
  auto* const view = cli::add_page(deploy_app_, deploy_.view);
  add_page_host(deploy_app_, [this] {
    return deploy_.view ? &*deploy_.view : nullptr;
  })->needs(view);
  deploy_app_.add_flag("--control", deploy_.control, "Let the page cause faults")->needs(view);
  add_log(deploy_app_, deploy_.log_level);
  deploy_app_.footer(
      "Each host already runs `rubicon host`; with --local the hosts are started here.\n"
      "A part that was killed is restarted, as its next life.\n"
      "Ctrl-C stops all hosts and reports the run so far, with status 130.");
  deploy_app_.final_callback([this] {
    if (deploy_.file == standard_input)
      throw CLI::ValidationError(
          "FILE", "it is sent with the files that it names: not from standard input");
  });
}

void hosts_command_line::add_swarm() {
  add_file(swarm_app_, swarm_.file);
  add_parsed(swarm_app_, "--seeds", "A..B", "The seeds, both ends included", [&](const auto& text) {
    swarm_.seeds = parse_seeds(text);
  })->required();
  auto* const jobs =
      add_parsed(swarm_app_, "--jobs", "N", "Number of parallel runs; default: one per core",
                 [&](const auto& text) { swarm_.jobs = parse_jobs(text); });
  add_parsed(swarm_app_, "--for", "TIME", "Ecology time of each run; default: the file's",
             [&](const auto& text) {
               static_cast<void>(parse_length(text));
               swarm_.length = text;
             });
  add_parsed(swarm_app_, "--timeout", "TIME",
             "Real time after which a run is aborted; default: 5min",
             [&](const auto& text) { swarm_.timeout = parse_length(text, "--timeout"); });
  add_settings(swarm_app_, swarm_.settings);
  swarm_app_.add_flag("--vary-faults", swarm_.varies_faults,
                      "Leave out each kind of fault in half of the runs, as with [ecology] "
                      "vary_faults = true");
  swarm_app_.add_flag("--json", swarm_.json, "Print one JSON object only");
  add_path(swarm_app_, "--report", "FILE", swarm_.page_file,
           "Write the results, and how they differ between seeds, as one HTML page");
  auto* const hosts =
      swarm_app_
          .add_option("--hosts", swarm_.hosts,
                      "Computers that run them, each with `rubicon host`: names of [[host]] of the "
                      "file or ADDRESS:PORT, separated by commas; default: this computer")
          ->delimiter(',')
          ->type_name("NAMES");
  jobs->excludes(hosts);
  add_tls(swarm_app_, swarm_.tls);
  swarm_app_.footer("Ctrl-C ends it with the results so far, and status 130.");
  swarm_app_.final_callback([this] {
    if (swarm_.file == standard_input)
      throw CLI::ValidationError("FILE", "each run reads it again: not from standard input");
  });
}

std::optional<command> hosts_command_line::parsed() const {
  if (deploy_app_.parsed())
    return deploy_;
  if (host_app_.parsed())
    return host_;
  if (status_app_.parsed())
    return deployed_command{ecology_, status_};
  if (stop_app_.parsed())
    return deployed_command{ecology_, stop_all{}};
  if (fault_app_.parsed())
    return deployed_command{ecology_, fault_};
  if (doctor_app_.parsed())
    return doctor_;
  if (swarm_app_.parsed())
    return swarm_;
  return std::nullopt;
}

} // namespace rubicon::cli
