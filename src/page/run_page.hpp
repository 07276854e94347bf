// A run on one page to send: HTML with its drawings in it, that needs nothing else and runs
// nothing.
#pragma once

#include <string>

#include "config/plan/ecology.hpp"
#include "report/history.hpp"
#include "report/report.hpp"

namespace rubicon::page {

struct run_page {
  const config::ecology_description& ecology;
  const report::run_report& report;
  const report::history& seen; ///< may be empty: then there are no curves
  std::string command;         ///< that repeats the run; empty: none does
  std::string digest;          ///< of the file's text
};

/// The whole document. Names and values, whoever chose them, are data in it.
[[nodiscard]] std::string html_of(const run_page& x);

} // namespace rubicon::page
