// The words of the commands that make certificates.
#pragma once

#include <optional>
#include <string>

#include "cli/words/command_line.hpp"

namespace CLI {
class App;
}

namespace rubicon::cli {

/// Adds `certs` to a command line.
class certs_command_line {
public:
  explicit certs_command_line(CLI::App& app);
  certs_command_line(const certs_command_line&) = delete;
  certs_command_line& operator=(const certs_command_line&) = delete;

  /// The command that was given, after parsing.
  [[nodiscard]] std::optional<certs_command> parsed() const;

private:
  CLI::App& add(const char* name, const char* text);
  void add_init();
  void add_host();
  void add_renew();
  void add_revoke();
  void add_list();

  CLI::App& app_;
  std::string folder_ = certs_command().folder;
  io::new_authority authority_;
  io::new_certificate host_;
  io::renewal renewal_;
  revoke_host revoked_;
  list_certificates list_;
};

} // namespace rubicon::cli
