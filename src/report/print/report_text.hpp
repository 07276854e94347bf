// How much of a report its text shows.
#pragma once

#include <cstddef>
#include <string>

#include "report/report.hpp"

namespace rubicon::report {

struct text_options {
  std::size_t width = 100; ///< of the terminal, in characters; below 60 it counts as 60
  bool colour = false;     ///< ANSI escapes
  bool cuts = true;        ///< no line is wider; false: tables and texts are as wide as they are
  bool full = false;       ///< every row, and every line of the event log
};

/// The report a person reads. Whatever it leaves out it says so.
[[nodiscard]] std::string to_text(const run_report& x, const text_options& options);

} // namespace rubicon::report
