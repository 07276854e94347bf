// Completion of the command line in shells, of the descriptions of commands.
#pragma once

#include <string>
#include <string_view>

#include "cli/words/command_description.hpp"

namespace rubicon::cli {

/// A script for bash, zsh or fish; empty for another shell.
[[nodiscard]] std::string completion_script(const command_description& all, std::string_view shell);

} // namespace rubicon::cli
