// The files of a run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "actors/base/debug_log.hpp"
#include "actors/base/frame_observer.hpp"
#include "actors/peis/tuple_notifier.hpp"
#include "actors/run/frame_captures.hpp"
#include "actors/run/run.hpp"
#include "actors/run/run_record.hpp"
#include "actors/serial/serial_recorder.hpp"
#include "config/plan/ecology.hpp"
#include "report/expect/expectations.hpp"
#include "report/history.hpp"
#include "scheduler/trace.hpp"

namespace rubicon {

/// What is written while the ecology runs.
class run_files {
public:
  /// @param judge notified of tuples; outlives this
  run_files(const config::ecology_description& description, const run_options& options,
            report::expectations& judge);

  void watch(scheduler::trace_recorder& trace);

  [[nodiscard]] bool records() const { return record_.has_value(); }
  void write(const report::run_sample& x);

  [[nodiscard]] frame_observer frames(); ///< empty if no file has frames

  /// What is not complete.
  [[nodiscard]] std::vector<std::string> finish();

private:
  report::expectations* judge_;
  std::optional<tuple_notifier> notifier_;
  std::optional<debug_log> debug_;
  std::optional<run_record> record_;
  std::optional<frame_captures> captures_;
  std::optional<serial_recorder> serial_;
};

} // namespace rubicon
