// From the words of the command line to one typed command.
#pragma once

#include <span>

#include "cli/words/command_line.hpp"

namespace rubicon::cli {

/// @param arguments the program's name first
[[nodiscard]] command parse_command_line(std::span<const char* const> arguments);

} // namespace rubicon::cli
