// Whether one expectation has come out.
#pragma once

#include <map>

#include "core/address.hpp"
#include "core/time.hpp"
#include "report/expect/expectation_watch.hpp"
#include "report/report.hpp"

namespace rubicon::report {

/// What is noticed for all expectations together.
struct noticed {
  std::map<mote_address, instant> joined; ///< for the first time
  bool hears_events = false; ///< else the report's lines are all that there is to judge by
};

/// @param run finished, but for its judgements
[[nodiscard]] expectation_report judge(const watched_expectation& x, const noticed& all,
                                       const run_report& run);

} // namespace rubicon::report
