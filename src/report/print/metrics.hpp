// The figures of a run as metrics that Prometheus collects (docs/metrics.md).
#pragma once

#include <string>

#include "report/report.hpp"

namespace rubicon::report {

struct metrics_options {
  bool motes = false; ///< also of each mote, not of islands alone
};

/// Names, kinds and units follow from the described structs of the report: `islands[].radio.acks`
/// is `rubicon_radio_acks_total{island="kitchen"}`. Durations are in seconds, octets bytes, charges
/// coulombs.
[[nodiscard]] std::string to_metrics(const run_report& x, const metrics_options& options = {});

} // namespace rubicon::report
