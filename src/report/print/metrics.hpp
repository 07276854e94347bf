// The figures of a run as metrics that Prometheus collects (docs/metrics.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/time.hpp"
#include "report/report.hpp"

namespace rubicon::report {

struct metrics_options {
  bool motes = false; ///< also of each mote, not of islands alone
};

/// How a report was collected.
struct collection {
  std::int64_t at_us = 0;         ///< UTC, microseconds since 1970
  std::optional<duration> took{}; ///< of the run's time; nothing: the run is over
};

/// When the figures below are from: they are as old as the report that they stand in.
[[nodiscard]] std::string to_metrics(const collection& x);

/// Names, kinds and units follow from the described structs of the report: `islands[].radio.acks`
/// is `rubicon_radio_acks_total{island="kitchen"}`. Durations are in seconds, octets bytes, charges
/// coulombs.
[[nodiscard]] std::string to_metrics(const run_report& x, const metrics_options& options = {});

} // namespace rubicon::report
