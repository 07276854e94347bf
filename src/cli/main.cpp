// The binary: every role, every command (GEN-01).
#include <exception>
#include <string>

#include "cli/check_command.hpp"
#include "cli/command_line.hpp"
#include "cli/console.hpp"
#include "cli/exit_status.hpp"
#include "cli/explain_command.hpp"
#include "cli/network_commands.hpp"
#include "cli/run_command.hpp"
#include "cli/swarm_command.hpp"

namespace {

namespace cli = rubicon::cli;
using cli::exit_status;

exit_status perform(const cli::show_command& x) {
  return cli::print(stdout, x.text) ? exit_status::good : exit_status::refused;
}

exit_status perform(const cli::refused_command& x) {
  static_cast<void>(cli::print(stderr, x.text));
  return exit_status::refused;
}

} // namespace

int main(int argc, char* argv[]) {
  try {
    const auto command = cli::parse_command_line({argv, static_cast<std::size_t>(argc)});
    return static_cast<int>(std::visit([](const auto& x) { return perform(x); }, command));
  } catch (const std::exception& error) {
    static_cast<void>(cli::print(stderr, "rubicon: " + std::string(error.what()) + '\n'));
    return static_cast<int>(exit_status::refused);
  }
}
