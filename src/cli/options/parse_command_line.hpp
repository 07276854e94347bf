// From the words of the command line to one typed command.
#pragma once

#include <span>

#include "cli/words/command_description.hpp"
#include "cli/words/command_line.hpp"

namespace rubicon::cli {

/// @param arguments the program's name first
[[nodiscard]] command parse_command_line(std::span<const char* const> arguments);

/// All commands with their options.
[[nodiscard]] command_description describe_commands();

} // namespace rubicon::cli
