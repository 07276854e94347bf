#include "cli/main.hpp"

#include <cerrno>
#include <csignal>
#include <exception>
#include <new>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "cli/certs_command.hpp"
#include "cli/check_command.hpp"
#include "cli/doctor_command.hpp"
#include "cli/hosts/deploy_command.hpp"
#include "cli/hosts/deployed_command.hpp"
#include "cli/hosts/host_command.hpp"
#include "cli/hosts/swarm_command.hpp"
#include "cli/imports/import_command.hpp"
#include "cli/manual/manual_commands.hpp"
#include "cli/manual/new_command.hpp"
#include "cli/network/network_commands.hpp"
#include "cli/options/parse_command_line.hpp"
#include "cli/print/console.hpp"
#include "cli/record/explain_command.hpp"
#include "cli/run/run_command.hpp"
#include "cli/run/view_command.hpp"
#include "cli/schema_command.hpp"
#include "cli/study/compare_command.hpp"
#include "cli/study/query_command.hpp"
#include "cli/study/shrink_command.hpp"
#include "cli/study/sweep_command.hpp"
#include "cli/study/when_command.hpp"
#include "cli/words/exit_status.hpp"
#include "cli/words/hint.hpp"
#include "core/text/printable.hpp"

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

/// Files opened later must not take the place of an output that was closed: a report would go into
/// a capture. What is written to one that was closed fails, as it should.
void occupy_standard_descriptors() {
  for (const int each : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(each, F_GETFD) == -1 && errno == EBADF)
      static_cast<void>(::open("/dev/null", O_RDONLY)); // the lowest that is free: this one
  }
}

/// A reader that has gone, and a limit on the size of files, are reported by the write itself.
void let_writes_fail() {
  static_cast<void>(::signal(SIGPIPE, SIG_IGN));
  static_cast<void>(::signal(SIGXFSZ, SIG_IGN));
}

bool has_run_out_of_memory = false;

/// Where memory ends nobody may be able to catch what is thrown, as within a destructor: that is no
/// fault of the program, and is reported as what it is. All else that nobody catches aborts.
void report_out_of_memory() {
  std::set_new_handler([] {
    has_run_out_of_memory = true;
    throw std::bad_alloc();
  });
  static const auto otherwise = std::get_terminate();
  std::set_terminate([] {
    if (!has_run_out_of_memory)
      otherwise();
    constexpr std::string_view text = "rubicon: out of memory\n";
    static_cast<void>(::write(STDERR_FILENO, text.data(), text.size()));
    ::_exit(static_cast<int>(exit_status::failed));
  });
}

/// What the binary has brought along, for commands that read files.
template <class Command>
void give(Command& x, const rubicon::config::extensions& known) {
  if constexpr (requires { x.known; })
    x.known = known;
}

} // namespace

int rubicon::main(int argc, char* argv[], const config::extensions& known) {
  occupy_standard_descriptors();
  let_writes_fail();
  report_out_of_memory();
  try {
    auto command = cli::parse_command_line({argv, static_cast<std::size_t>(argc)});
    return static_cast<int>(std::visit(
        [&known](auto& x) {
          give(x, known);
          return perform(x);
        },
        command));
  } catch (const std::bad_alloc&) {
    static_cast<void>(cli::print(stderr, "rubicon: out of memory\n"));
    return static_cast<int>(exit_status::failed);
  } catch (const std::exception& error) {
    static_cast<void>(
        cli::print(stderr, "rubicon: " + rubicon::printable(cli::with_hint(error.what())) + '\n'));
    return static_cast<int>(exit_status::refused);
  }
}
