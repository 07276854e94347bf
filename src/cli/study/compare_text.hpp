// What `rubicon compare` prints of two sets of runs.
#pragma once

#include <cstddef>
#include <string>

#include "study/comparison.hpp"

namespace rubicon::cli {

/// Two sets of runs and what differs between them.
struct shown_comparison {
  std::string a; ///< what is compared, as it was given
  std::string b;
  std::size_t pairs = 0;
  std::size_t single = 0; ///< runs that only one side has
  study::comparison found;
};

/// Of those that differ without being sure, `unsure_max` are shown unless all are asked for.
inline constexpr std::size_t unsure_max = 5;

/// What was compared, how it was judged, and a table.
[[nodiscard]] std::string comparison_text(const shown_comparison& x, bool all, std::size_t width,
                                          bool colour);

/// A line for each figure that differs.
[[nodiscard]] std::string comparison_csv(const study::comparison& x);

} // namespace rubicon::cli
