// How much of a report its text shows.
#pragma once

#include <cstddef>
#include <string>

#include "config/plan/labels.hpp"
#include "config/run/variation.hpp"
#include "report/report.hpp"

namespace rubicon::report {

struct text_options {
  std::size_t width = 100; ///< of the terminal, in characters; below 60 it counts as 60
  bool colour = false;     ///< ANSI escapes
  bool cuts = true;        ///< no line is wider; false: tables and texts are as wide as they are
  bool full = false;       ///< every row, and every line of the event log
  bool brief = false;      ///< only the verdict, with what the file expects
  config::label_table labels = {}; ///< shown beside names
  config::variation varied = {};   ///< what the seed has decided of the file
};

/// The report a person reads. Whatever it leaves out it says so, unless it is brief.
[[nodiscard]] std::string to_text(const run_report& x, const text_options& options);

} // namespace rubicon::report
