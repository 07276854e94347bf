// Recorded readings that transducers replay (STR-21).
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/time.hpp"

namespace rubicon::device {

/// Values with their times, which strictly increase.
using time_series = std::vector<std::pair<duration, double>>;

/// One column of a trace. Times count from the start of the run, and may be before it.
struct trace_table {
  std::map<std::uint32_t, time_series> of_mote; ///< none empty; only 0 if the trace has no motes
  /// From the start of the run to the last reading, and as long again as that one is after the one
  /// before it; the longest of all motes.
  duration turn{};
  std::uint64_t skipped = 0;  ///< lines without a time, a mote or a value
  std::uint64_t repeated = 0; ///< readings for whose mote and time a later line has another

  friend bool operator==(const trace_table&, const trace_table&) = default;
};

} // namespace rubicon::device
