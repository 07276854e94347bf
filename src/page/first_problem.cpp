// What went wrong first, and what had happened until then.
#include <algorithm>
#include <vector>

#include "config/summary_parts.hpp"
#include "page/markup.hpp"
#include "page/parts.hpp"
#include "report/fault_plan.hpp"
#include "report/figures.hpp"

namespace rubicon::page {

namespace {

constexpr std::size_t events_shown = 6;

/// The newest fault of the plan that is not later; nothing: there was none.
std::string fault_before(const run_page& x, instant at) {
  if (x.ecology.faults.empty())
    return {};
  const auto rows = config::fault_rows(x.ecology);
  std::string text;
  for (const auto& each : report::plan_faults(x.ecology)) {
    if (instant{} + each.at > at)
      break;
    text = report::run_time(instant{} + each.at) + "  " + config::fault_text(rows.at(each.index));
  }
  return text;
}

/// The newest events that are not later, in order of time.
std::string events_before(const run_page& x, instant at) {
  const auto& all = x.report.event_log;
  const auto end = std::ranges::upper_bound(all, at, {}, &report::logged_event::at);
  const auto count = std::min(events_shown, static_cast<std::size_t>(end - all.begin()));
  if (count == 0)
    return {};
  auto rows = head_row({{"time", true}, {"who"}, {"event"}});
  for (auto each = end - static_cast<std::ptrdiff_t>(count); each != end; ++each)
    rows += row({{report::run_time(each->at), true},
                 {labelled(x, each->who), false, "name"},
                 {each->what, false, "long"}});
  return "<h3>Events before it</h3>" + wide("<table>" + rows + "</table>");
}

/// What it says, and the command that explains it, if it is an expectation that is not met.
std::string words_of(const run_page& x, const report::violation& first) {
  const auto words = [&first](const std::string& detail) {
    return element("p",
                   report::run_time(first.at) + "  " + first.invariant +
                       (detail.empty() ? "" : ": " + detail),
                   "class='bad'");
  };
  for (const auto& each : x.report.expectations)
    if (!each.command.empty() && each.at == first.at && first.invariant.ends_with(each.text))
      return words(each.measured) + element("p", "It is explained by", "class='soft'") +
             element("pre", each.command);
  return words(first.detail);
}

} // namespace

std::string first_problem_of(const run_page& x) {
  const auto& all = x.report.violations;
  const auto first = std::ranges::min_element(all, {}, &report::violation::at);
  if (first == all.end())
    return {};
  const auto fault = fault_before(x, first->at);
  const auto before = fault.empty()
                          ? element("p", "No fault of the plan came before it.", "class='soft'")
                          : element("p", "Newest fault before it: " + fault);
  return section("first", "First violation",
                 words_of(x, *first) + before + events_before(x, first->at));
}

} // namespace rubicon::page
