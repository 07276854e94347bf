// The words of `rubicon serial`.
#pragma once

#include <optional>

#include "cli/serial_command.hpp"

namespace CLI {
class App;
}

namespace rubicon::cli {

/// Adds them to an app, which it must not outlive.
class serial_command_line {
public:
  explicit serial_command_line(CLI::App& app);

  /// Nothing if the line has another command.
  [[nodiscard]] std::optional<serial_command> parsed() const;

private:
  CLI::App& add(CLI::App& below, const char* name, const char* text);
  void add_payload_max(CLI::App& app);

  serial_command with_;
  listen_serial listen_;
  send_serial send_;
  forward_serial forward_;
  CLI::App* listen_app_ = nullptr;
  CLI::App* send_app_ = nullptr;
  CLI::App* forward_app_ = nullptr;
};

} // namespace rubicon::cli
