// Runs whole ecologies with a record, and looks into it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "config/plan/ecology.hpp"
#include "core/time.hpp"
#include "explain/record.hpp"
#include "report/report.hpp"

namespace rubicon::test {

/// A value that somebody set, and when.
struct set_value {
  instant time;
  std::string text;
};

struct recorded {
  report::run_report report;
  explain::recording content;

  /// When such things happened to actors whose path begins so.
  [[nodiscard]] std::vector<instant> times(explain::kind what, std::string_view to,
                                           std::string_view text = {}) const;

  /// What was set under an own key, in order.
  [[nodiscard]] std::vector<set_value> at(std::string_view key) const;
  [[nodiscard]] std::vector<std::string> texts_at(std::string_view key) const;
};

/// The record's file is gone when this returns; it has not been cut off.
[[nodiscard]] recorded run_recorded(const config::ecology_description& what,
                                    std::uint64_t seed = 1);

} // namespace rubicon::test
