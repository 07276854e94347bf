// The words of the commands that run ecologies in several processes and on several computers.
#pragma once

#include <optional>
#include <string>

#include "cli/words/command_line.hpp"

namespace CLI {
class App;
}

namespace rubicon::cli {

/// Adds `deploy`, `host`, `status`, `stop`, `fault`, `doctor` and `swarm` to a command line.
class hosts_command_line {
public:
  explicit hosts_command_line(CLI::App& app);
  hosts_command_line(const hosts_command_line&) = delete;
  hosts_command_line& operator=(const hosts_command_line&) = delete;

  /// The command that was given, after parsing.
  [[nodiscard]] std::optional<command> parsed() const;

private:
  void add_deploy();
  void add_host();
  void add_deployed();
  void add_doctor();
  void add_swarm();

  CLI::App& deploy_app_;
  CLI::App& host_app_;
  CLI::App& status_app_;
  CLI::App& stop_app_;
  CLI::App& fault_app_;
  CLI::App& doctor_app_;
  CLI::App& swarm_app_;
  deploy_command deploy_;
  host_command host_;
  std::string ecology_; ///< of status, stop and fault
  ask_status status_;
  fault_now fault_;
  doctor_command doctor_;
  swarm_command swarm_;
};

} // namespace rubicon::cli
