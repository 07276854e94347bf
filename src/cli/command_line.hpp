// From the words of the command line to one typed command.
#pragma once

#include <span>
#include <string>
#include <variant>

#include "actors/run.hpp"
#include "config/load.hpp"

namespace rubicon::cli {

/// `rubicon run FILE`
struct run_command {
  std::string file;
  run_options options;
  config::overrides instead; ///< files, and the seed of `options`
  bool json = false;
  bool check_determinism = false; ///< ACT-05
  std::string log_level = "warn"; ///< trace, debug, info, warn, error or off
};

/// `rubicon check FILE`
struct check_command {
  std::string file;
  config::overrides instead;
};

/// `--help` and `--version`: text for standard output.
struct show_command {
  std::string text;
};

/// A command line that makes no sense: text for standard error.
struct refused_command {
  std::string text;
};

using command = std::variant<run_command, check_command, show_command, refused_command>;

/// @param arguments the program's name first
[[nodiscard]] command parse_command_line(std::span<const char* const> arguments);

} // namespace rubicon::cli
