// The options of a command line, as data.
#pragma once

#include "cli/words/command_description.hpp"

namespace CLI {
class App;
}

namespace rubicon::cli {

/// @param words of the command; none: all of the binary
[[nodiscard]] command_description describe(const CLI::App& app,
                                           const std::vector<std::string>& words = {});

} // namespace rubicon::cli
