// From a description of an ecology to the report of a run: all that a command needs to know.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "actors/run/run_source.hpp"
#include "config/plan/ecology.hpp"
#include "core/numbers/random.hpp"
#include "io/loop.hpp"
#include "report/history.hpp"
#include "report/report.hpp"
#include "report/run_counters.hpp"

namespace rubicon {

/// How far a run has come.
struct run_progress {
  instant reached;          ///< ecology time
  instant end;              ///< of the run
  std::uint64_t events = 0; ///< messages delivered to actors so far
};

/// What may be done to a run in wall time while it runs, from handlers of its loop.
struct run_control {
  io::loop& loop;
  std::function<void()> stop; ///< ends it early, and cleanly
  /// Lets a fault happen now: one that needs nothing but what has been there from the start.
  std::function<void(const config::fault&)> apply;
  /// Lets a fault or a change join the plan, at its times that are not over yet; it needs no more.
  std::function<void(const config::fault_description&)> plan;
  std::function<instant()> now;
  /// Sets a tuple of a peer, as one of its own components would. @returns false: no such peer runs
  std::function<bool(const std::string& peer, const std::string& key, const std::string& value)>
      set_tuple;
};

/// What a command line may override or ask for beside the file.
struct run_options {
  std::optional<duration> length;
  std::optional<std::uint64_t> seed;
  std::optional<config::run_mode> mode;
  double speed = 0; ///< ecology seconds per real second; 0: virtual as fast as possible,
                    ///< wall 1
  std::optional<reseeding::settings> reseed; ///< in virtual time: other random numbers from then on
  unsigned threads = 1;     ///< that execute islands and PCs at the same time, in virtual time;
                            ///< what comes out is the same for any number
  std::string debug_folder; ///< NFR-01; empty: no debug logs
  std::vector<std::string> debug_of = {"*"}; ///< whose messages, from the start (NFR-02): patterns
                                             ///< of config::debug_selection
  std::size_t debug_file_octets_max = 16 << 20; ///< a full file is rotated (NFR-03)
  std::string pcap_folder; ///< ACT-07: a capture of each island's air goes here; empty: none
  bool pcap_lost = false;  ///< with the frames that no radio received
  std::string serial_file; ///< ACT-08: each frame of serial lines goes here; empty: nowhere
  std::string record_file; ///< what `rubicon explain` reads goes here; empty: nowhere
  std::uint64_t record_octets_max =
      0;                       ///< then it ends, and may be incomplete; 0: it must be complete
  run_source source;           ///< a record has it
  bool handle_signals = false; ///< end the run cleanly on the first signal (ACT-11)

  /// Called now and then.
  std::function<void(const run_progress&)> progress;

  // What is to be seen while it runs; looking changes nothing.
  /// Ecology time between two samples; 0: none. A run that is recorded takes some all the same.
  duration look_every{};
  std::function<void(const report::run_sample&)> on_sample; ///< at each, and at the end
  std::function<void(const report::tuple_write&)> on_tuple; ///< as a component asks its peer for it

  /// In wall time, called about as often with the report so far; everybody is asked for it. Where
  /// that takes long it is called less often (report_schedule). @param took real time
  duration report_every{}; ///< real time; 0: never
  std::function<void(report::run_report, duration took)> on_report;

  /// In wall time, called at each SIGHUP, which does not end the run then; empty: it does.
  std::function<void()> on_hangup;

  // Of one part of an ecology on several hosts: notifications, and requests.
  /// Called when everything has been made and nothing has run.
  std::function<void(run_control)> on_begun;
  std::function<void(const report::logged_event&)> on_event; ///< as it is noted
  /// What a report is settled from, before each: report_so_far() has one as well.
  std::function<void(const report::run_counters&)> on_counters;
  std::uint32_t starts = 0;                     ///< by processes before this one
  std::function<void(std::uint32_t)> on_starts; ///< more than anything has been started before
};

/// Runs an ecology to its end and collects the report. If the run breaks off, for whatever reason,
/// the report is not complete, says why, and has a violation; files that could not be written to
/// their end are violations too.
/// @throws std::runtime_error if the debug folder, a capture or the record cannot be begun
[[nodiscard]] report::run_report run_ecology(config::ecology_description description,
                                             const run_options& options);

} // namespace rubicon
