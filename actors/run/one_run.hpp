// One run of an ecology: its world, its root supervisor, and what ends it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "actors/base/failure.hpp"
#include "actors/run/lifetime.hpp"
#include "actors/run/run.hpp"
#include "actors/run/run_files.hpp"
#include "actors/supervision/ecology.hpp"
#include "config/plan/ecology.hpp"
#include "core/numbers/report_schedule.hpp"
#include "io/process/hangup_watch.hpp"
#include "io/process/signal_watch.hpp"
#include "report/expect/expectations.hpp"
#include "scheduler/world.hpp"

namespace rubicon {

/// As the report has it.
[[nodiscard]] const char* mode_name(const config::ecology_description& x);

/// One run from its first event to its report. Everything in `report` stays what it is until it
/// is known better: a run that breaks off anywhere is not complete.
class one_run {
public:
  one_run(const config::ecology_description& description, const run_options& options,
          run_files& files, report::expectations& judge, report::run_report& report);
  ~one_run();

  one_run(const one_run&) = delete;
  one_run& operator=(const one_run&) = delete;

  [[nodiscard]] scheduler::world& world() { return world_; }
  [[nodiscard]] const root_actor& root() const { return root_; }
  [[nodiscard]] const std::string& ended_early() const { return ended_early_; }

  [[nodiscard]] report::run_report report_so_far();
  void plan(const config::fault_description& x, const std::vector<duration>& times);
  void run_until(instant end) { static_cast<void>(run_to(end)); }

  void perform();

  /// What the run has been, however it ended.
  void measure();

private:
  /// With other random numbers from the time on that was asked for.
  scheduler::stop_cause run_to(instant end);

  /// Stops to look whether frames of motes are received and motes know the time, and to take a
  /// sample where one is wanted.
  scheduler::stop_cause run_on(instant end);
  void note_standstill(duration length);
  /// In wall time.
  void report_on_time();
  [[nodiscard]] instant next_multiple(duration every);
  [[nodiscard]] duration look_every() const;
  void look();
  [[nodiscard]] ecology_state& root_state();
  void apply(const config::fault& x);
  void plan_rest(const config::fault_description& x);
  bool set_tuple_of(const std::string& peer, const std::string& key, const std::string& value);
  void take(report::run_report& x);
  void break_off(const std::string& why);

  /// To the root supervisor, with all that follows from it at this instant.
  template <class Message>
  void deliver(Message x) {
    post(root_, x);
    if (!world_.drain() && ended_early_.empty())
      ended_early_ = "actors kept sending each other messages without end";
  }

  /// Peers say goodbye, and inits stop their components.
  void leave();
  void on_root_ended(const caf::error& reason);
  void end_early(const std::string& why);

  /// In wall time peers may meet those of other processes, and must be distinguishable from them.
  process_facts facts();

  report::expectations& judge_;
  run_files& files_;
  const config::ecology_description& description_;
  const run_options& options_;
  report::run_report& report_;
  const bool wall_;
  report_schedule reports_;
  const double speed_;
  std::string ended_early_; ///< why; empty while nothing is wrong
  bool over_ = false;
  bool is_so_far_ = false;            ///< the report that is being made: the run goes on behind it
  std::optional<reseeding> reseeded_; ///< once its time has come
  std::uint64_t timers_ = 0;          ///< that waited at the end
  scheduler::world world_;
  lifetime lifetime_;
  bool inits_run_;
  std::optional<io::signal_watch> signals_;
  std::optional<io::hangup_watch> hangups_;
  root_actor root_;
};

} // namespace rubicon
