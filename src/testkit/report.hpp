// What a report says, as tests ask for it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "runtime/report.hpp"

namespace rubicon::test {

/// Whether somebody whose name ends with `who` is told to have done something that begins with
/// `what`: a line of the story that `rubicon run` prints.
[[nodiscard]] bool tells(const std::vector<runtime::story_line>& story, std::string_view who,
                         std::string_view what);
[[nodiscard]] bool tells(const runtime::report& x, std::string_view who, std::string_view what);

/// A line for each violated invariant; empty: there is none.
[[nodiscard]] std::string told_violations(const runtime::report& x);

/// The proxy of that name. @throws failure if there is none
[[nodiscard]] const runtime::proxy_report& proxy_of(const runtime::report& x,
                                                    std::string_view name);

/// What a proxy says under that name; empty if nothing.
[[nodiscard]] std::string value(const runtime::proxy_report& x, std::string_view name);

} // namespace rubicon::test
