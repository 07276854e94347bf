// The words of the commands that look into a PEIS network.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "cli/words/network_command.hpp"

namespace CLI {
class App;
}

namespace rubicon::cli {

/// Adds `tuples`, `hosts`, `route` and `ping` to a command line.
class network_command_line {
public:
  explicit network_command_line(CLI::App& app);

  /// The one that was given, after parsing.
  [[nodiscard]] std::optional<network_command> parsed() const;

private:
  struct subcommand {
    CLI::App* app;
    std::function<network_command()> make;
  };

  template <class What>
  What& add(CLI::App& below, const char* name, const char* text);

  network_options with_;
  std::vector<subcommand> all_;
};

} // namespace rubicon::cli
