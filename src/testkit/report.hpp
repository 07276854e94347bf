// What a report says, as tests ask for it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "report/report.hpp"

namespace rubicon::test {

/// Whether the log has an event of somebody whose name ends with `who` that begins with
/// `what`: a line of the event log that `rubicon run` prints.
[[nodiscard]] bool has_logged(const std::vector<report::logged_event>& log, std::string_view who,
                              std::string_view what);
[[nodiscard]] bool has_logged(const report::run_report& x, std::string_view who,
                              std::string_view what);

/// A line for each violated invariant; empty: there is none.
[[nodiscard]] std::string told_violations(const report::run_report& x);

/// The proxy of that name. @throws failure if there is none
[[nodiscard]] const report::proxy_report& proxy_of(const report::run_report& x,
                                                   std::string_view name);

/// What a proxy says under that name; empty if nothing.
[[nodiscard]] std::string value(const report::proxy_report& x, std::string_view name);

} // namespace rubicon::test
