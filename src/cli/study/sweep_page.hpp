// The HTML page of a sweep.
#pragma once

#include <string>

#include "cli/study/sweep_text.hpp"
#include "cli/words/command_line.hpp"

namespace rubicon::cli {

/// @param from_wall the file says wall: commands that replay a run must say virtual
[[nodiscard]] std::string sweep_page(const sweep_command& x, const study_summary& summary,
                                     bool from_wall);

} // namespace rubicon::cli
