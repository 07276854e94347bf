// When a run that goes on is asked for its report so far.
#pragma once

#include <algorithm>

#include "core/time.hpp"

namespace rubicon {

/// Everybody is asked for a report, and waits for nobody else meanwhile: a run of many motes takes
/// long for it. The pause after a report is at least a hundred times as long as the report took, so
/// that a run gives less than a hundredth of its time to reports, however large it is.
///
/// Times are real ones, since any moment that stays the same.
class report_schedule {
public:
  static constexpr int pause_factor = 100;

  /// @param every so often where reports take no longer than a hundredth of it; 0: never
  explicit report_schedule(duration every) : every_(every) {}

  /// The first one is due at once.
  [[nodiscard]] bool is_due(duration now) const { return every_ > 0s && now >= next_; }

  void on_report(duration begun, duration ended) {
    next_ = std::max(begun + every_, ended + pause_factor * (ended - begun));
  }

private:
  duration every_;
  duration next_ = duration::min();
};

} // namespace rubicon
