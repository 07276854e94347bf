// What a command line asks for: a type for each command.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "actors/run/run.hpp"
#include "cli/serial_command.hpp"
#include "cli/swarm.hpp"
#include "cli/words/network_command.hpp"
#include "cli/words/original_options.hpp"
#include "cli/words/watch_options.hpp"
#include "config/load.hpp"
#include "control/tls.hpp"
#include "deploy/host_access.hpp"
#include "explain/print/text.hpp"
#include "imports/plan.hpp"
#include "io/tls/certificates.hpp"
#include "study/grid.hpp"
#include "study/stopping.hpp"

namespace rubicon::cli {

/// `rubicon run FILE`
struct run_command {
  std::string file;
  bool is_bundled = false; ///< it is a deploy::bundle, as `rubicon host` writes it
  run_options options;
  config::overrides instead; ///< files, and the seed of `options`
  config::extensions known;
  bool json = false;
  bool full = false;      ///< every row, as text
  bool brief = false;     ///< the verdict only, as text
  bool is_strict = false; ///< a warning of the file is an error
  watch_options watch;
  bool reloads = false;           ///< on SIGHUP, in wall time (ACT-10)
  bool check_determinism = false; ///< ACT-05
  std::string host;               ///< only its part, in wall time; empty: all of the file
  std::string starts_file;        ///< with `host`; empty: one of the user
  duration elapsed{};             ///< with `host`: the others have run for so long
  std::string part_file; ///< with `host`: reports go there, as deploy reads them; empty: printed
  std::string log_level = "warn"; ///< trace, debug, info, warn, error or off
  original_options original;      ///< --peis-id and so on
  /// The options that decide what runs, word by word as they were given, but --seed and --for.
  std::vector<std::string> deciding;
  std::string steer; ///< a socket or file with requests; empty: nobody steers the run
};

/// `rubicon check FILE`
struct check_command {
  std::string file;
  config::overrides instead;
  config::extensions known;
  std::string changes_from; ///< file of a run that is to read FILE again; empty: none
  bool list = false;        ///< motes, peers and tuples instead of a summary
  bool is_strict = false;   ///< a warning is an error
};

/// `rubicon check --explain KEY`
struct explain_key_command {
  std::string key; ///< `island.duty_cycle.period`, or its last parts; * stands for parts
};

/// `rubicon new TEMPLATE [FILE]`
struct new_command {
  std::string name;       ///< of the template; empty: list them
  std::string file;       ///< empty: NAME.toml
  bool is_forced = false; ///< overwrites a file
  std::string firmware;   ///< folder for firmware in C instead; empty: none is written
  std::string lua;        ///< folder for a program in Lua instead; empty: none is written
  std::string python;     ///< folder for a study in Python instead; empty: none is written
};

/// `rubicon import FILE [TOML]`
struct import_command {
  std::string file;
  std::string to;                        ///< empty: FILE's name with .toml; `-`: standard output
  std::optional<imports::format> format; ///< unset: by FILE's name and content
  std::string sink;                      ///< the mote that is it; empty: the first one that stays
  bool is_forced = false;                ///< overwrites a file
};

/// `rubicon completion SHELL`
struct completion_command {
  std::string shell; ///< bash, zsh or fish
};

/// `rubicon help --pages DIR`: writes all pages of the manual, for packages
struct pages_command {
  std::string folder;
  std::string date = "2001-01-01"; ///< of the pages, YYYY-MM-DD
};

/// `rubicon deploy FILE`
struct deploy_command {
  std::string file;
  config::extensions known;
  std::optional<duration> length;
  std::optional<std::uint64_t> seed;
  bool local = false;   ///< all hosts are processes of this computer
  bool dry_run = false; ///< only prints what would run where, and whether it could
  bool attach = false;  ///< follows what runs already
  bool json = false;
  bool full = false;              ///< every row, as text
  bool brief = false;             ///< the verdict only, as text
  std::string page_file;          ///< HTML goes here; empty: nowhere
  std::optional<page_place> view; ///< serves the live page
  bool control = false;           ///< which lets faults happen
  std::string log_level = "warn"; ///< as of run; `off`: not even what happens
  control::tls_files tls;
};

/// `rubicon host`
struct host_command {
  std::string name;                  ///< as `[[host]]` has it
  std::string address = "127.0.0.1"; ///< where it takes commands
  std::uint16_t port = 4242;
  control::tls_files tls;
  deploy::host_access access;
  std::string state_folder;             ///< empty: one of the user
  std::string files_folder;             ///< where parts write; empty: one in that of the state
  std::optional<metrics_place> metrics; ///< serves metrics
  config::extensions known;
};

/// `rubicon status`
struct ask_status {
  bool json = false;
};
/// `rubicon stop`
struct stop_all {};
/// `rubicon fault SENTENCE`
struct fault_now {
  std::string sentence;
};

/// What is done to a deployment that runs.
struct deployed_command {
  std::string ecology; ///< its name; empty: the one that was deployed last
  std::variant<ask_status, stop_all, fault_now> what;
};

/// `rubicon doctor [FILE]`
struct doctor_command {
  std::string file; ///< whose hosts are looked at; empty: only this computer
  config::extensions known;
  control::tls_files tls;
  bool json = false;
};

/// `rubicon schema`
struct schema_command {
  std::string tables_of; ///< a document whose tables of keys are made anew; empty: JSON Schema
};

/// `rubicon swarm FILE`
struct swarm_command {
  std::string file;
  config::extensions known;
  seed_range seeds;
  std::optional<std::uint64_t> jobs; ///< runs at a time, 1 to 1024; unset: one a core
  std::string length; ///< as given, understood by `run --for`; empty: as the file says
  config::settings settings;
  duration timeout = 5min; ///< of real time, for each run
  bool json = false;
  bool varies_faults = false;     ///< each seed leaves out kinds of faults
  std::string page_file;          ///< HTML goes here; empty: nowhere
  std::vector<std::string> hosts; ///< `[[host]]` of the file or ADDRESS:PORT; none: this computer
  control::tls_files tls;         ///< with `hosts`
};

/// `rubicon sweep FILE`
struct sweep_command {
  std::string file;
  config::extensions known;
  config::settings settings;
  std::vector<study::variation> variations;
  seed_range seeds;
  std::optional<std::uint64_t> jobs; ///< as of swarm
  std::string length;                ///< the same
  duration timeout = 5min;           ///< the same
  std::string database;
  std::vector<std::string> scalars;      ///< that the summary shows; none: the usual ones
  std::optional<study::stop_rule> until; ///< unset: all seeds
  std::optional<double> quantile;        ///< shown in the place of the mean, 0 to 1
  std::string page_file;                 ///< HTML goes here; empty: nowhere
  std::string series_every;              ///< time between points of series; empty: none are kept
  bool csv = false;
};

/// `rubicon compare A B`
struct compare_command {
  std::string a;    ///< file, binary, database of a sweep, or record
  std::string b;    ///< the same kind
  std::string file; ///< that two binaries run
  config::extensions known;
  config::settings settings;
  seed_range seeds{1, 20};
  std::optional<std::uint64_t> jobs; ///< as of swarm
  std::string length;                ///< the same
  duration timeout = 5min;           ///< the same
  std::vector<std::string> scalars;  ///< that are compared; none: all but real time
  bool full = false;                 ///< also all that differ without being sure
  bool csv = false;
};

/// `rubicon shrink FILE`
struct shrink_command {
  std::string file;
  config::extensions known;
  config::settings settings;
  std::uint64_t seed = 1;
  duration timeout = 5min; ///< as of swarm
  std::string out;         ///< the smallest file; empty: NAME.small.toml beside FILE
};

/// `rubicon query DATABASE SQL`
struct query_command {
  std::string database;
  std::string sql;
  bool csv = false;
};

/// `rubicon view RECORD`
struct view_command {
  std::string record;
  page_place where;
};

/// `rubicon explain RECORD [WHAT]`
struct explain_command {
  std::string record;
  std::string what;           ///< message or tuple; empty: what is there?
  std::optional<duration> at; ///< of a tuple: its value at this time
  bool all = false;           ///< of a tuple: all its values
  explain::listing list;
  bool json = false;
  std::string trace_events; ///< file to write the whole record to; empty: none
  std::string mcap;         ///< likewise
};

/// `rubicon explain --when RECORD [VIOLATION]`
struct when_command {
  std::string record;
  std::string what; ///< words of the violation; empty: the first
  config::extensions known;
  std::uint64_t futures = 20;        ///< runs that each time is judged by
  duration within = 100ms;           ///< how exact the time is
  std::optional<std::uint64_t> jobs; ///< as of swarm
  duration timeout = 5min;           ///< the same
  bool json = false;
};

/// `rubicon certs list`
struct list_certificates {
  bool json = false;
};

/// `rubicon certs revoke`
struct revoke_host {
  std::string host;
};

/// `rubicon certs init`, `add HOST`, `renew HOST`, `revoke HOST` and `list`
struct certs_command {
  std::string folder = "certs";
  std::variant<io::new_authority, io::new_certificate, io::renewal, revoke_host, list_certificates>
      what;
};

/// `--help` and `--version`: text for standard output.
struct show_command {
  std::string text;
};

/// A command line that makes no sense: text for standard error.
struct refused_command {
  std::string text;
};

using command =
    std::variant<run_command, deploy_command, host_command, deployed_command, doctor_command,
                 check_command, explain_key_command, new_command, import_command, schema_command,
                 completion_command, pages_command, swarm_command, sweep_command, compare_command,
                 shrink_command, query_command, explain_command, when_command, view_command,
                 certs_command, network_command, serial_command, show_command, refused_command>;

} // namespace rubicon::cli
