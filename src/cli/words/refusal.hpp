// What is printed of a command line that is refused.
#pragma once

#include <span>
#include <string>

namespace CLI {
class App;
}

namespace rubicon::cli {

/// What a refused line has that is no command or option; empty if there is no such word.
[[nodiscard]] std::string unknown_word(const CLI::App& app, std::span<const char* const> arguments);

/// The reason, and the help of the command that was meant.
[[nodiscard]] std::string refusal(const CLI::App& app, std::span<const char* const> arguments,
                                  const std::string& why);

} // namespace rubicon::cli
