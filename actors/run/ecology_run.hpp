// A run that somebody may stop to look at, and go on with.
#pragma once

#include <memory>
#include <vector>

#include "actors/messages/supervision.hpp"
#include "actors/run/run.hpp"
#include "config/plan/ecology.hpp"
#include "core/time.hpp"
#include "report/report.hpp"
#include "scheduler/world.hpp"

namespace rubicon {

/// A run that goes on as far as it is requested to, for users that look at it in between.
class ecology_run {
public:
  /// @throws std::runtime_error if the debug folder, a capture or the record cannot be begun
  ecology_run(config::ecology_description description, run_options options);
  ~ecology_run();
  ecology_run(ecology_run&&) noexcept;
  ecology_run& operator=(ecology_run&&) noexcept;

  /// Its actors and its time, until finish(). @throws std::runtime_error if the run has broken off
  [[nodiscard]] scheduler::world& world();
  [[nodiscard]] const root_actor& root();

  /// Lets a fault or a change join the plan. @param times not before now. @throws as world()
  void plan(const config::fault_description& x, const std::vector<duration>& times);

  /// Runs on to that time, and looks at the motes meanwhile as a whole run does. @throws as
  /// world()
  void run_until(instant end);

  /// What the report would be if the run were over; what is expected of the run is not judged yet.
  /// Everybody is asked at this instant: the run goes on as it would have, but its trace and its
  /// events hold the questions and answers. @throws as world()
  [[nodiscard]] report::run_report report_so_far();

  /// Runs it to its end, if that has not come yet, and collects the report, as run_ecology() does.
  /// To be called once, at last.
  [[nodiscard]] report::run_report finish();

private:
  class parts;
  std::unique_ptr<parts> parts_;
};

} // namespace rubicon
