// Figures over the time of a run, from the tables that it writes (docs/data.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rubicon::study {

struct series_point {
  std::string name;
  double at_s = 0;
  double value = 0;

  friend bool operator==(const series_point&, const series_point&) = default;
};

/// The sums of one column over all rows of a time, by name and time.
/// @param csv     a table with a header that has `time_s`
/// @param value   the column; rows where it is no number are left out
/// @param name    of the series
/// @param columns whose values are parts of the name, too: `losses.mac.no_ack`
/// @returns nothing if the table lacks a column
[[nodiscard]] std::vector<series_point> summed_series(std::string_view csv, std::string_view value,
                                                      std::string_view name,
                                                      const std::vector<std::string>& columns = {});

} // namespace rubicon::study
