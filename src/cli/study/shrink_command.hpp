// `rubicon shrink FILE`
#pragma once

#include <string>
#include <string_view>

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"
#include "report/report.hpp"

namespace rubicon::cli {

/// Writes the smallest file that has the same violation, and its record.
[[nodiscard]] exit_status perform(const shrink_command& x);

/// Whom a violation is about: `kitchen/shelf` of `kitchen/shelf: never joined`, `a` of `a was
/// silent for 3 min`; empty for one of an expectation, whose text is in the invariant.
[[nodiscard]] std::string subject_of_violation(std::string_view invariant, std::string_view detail);

/// The same invariant is violated about the same subject.
[[nodiscard]] bool is_same(const report::violation& x, const report::violation& y);

} // namespace rubicon::cli
