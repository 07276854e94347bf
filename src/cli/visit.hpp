// For files of this room only: where a network command works.
#pragma once

#include <string>

#include "cli/exit_status.hpp"
#include "cli/guest.hpp"
#include "io/loop.hpp"

namespace rubicon::cli {

/// Of one command, while it runs.
struct visit {
  io::loop& loop;
  const network_options& with;
  guest& self;

  [[nodiscard]] peer::standalone& peer() const { return self.peer(); }
};

/// One line on standard error.
[[nodiscard]] exit_status fail(const std::string& why);

/// Prints the result of a command.
[[nodiscard]] exit_status answer(const std::string& text);

// tuple_commands.cpp
[[nodiscard]] exit_status perform(const visit& at, const get_tuple& x);
[[nodiscard]] exit_status perform(const visit& at, const write_tuple& x);
[[nodiscard]] exit_status perform(const visit& at, const delete_tuple& x);
[[nodiscard]] exit_status perform(const visit& at, const meta_tuple& x);
[[nodiscard]] exit_status perform(const visit& at, const list_tuples& x);
[[nodiscard]] exit_status perform(const visit& at, const watch_tuples& x);

// host_commands.cpp
[[nodiscard]] exit_status perform(const visit& at, const list_hosts& x);
[[nodiscard]] exit_status perform(const visit& at, const trace_route& x);
[[nodiscard]] exit_status perform(const visit& at, const ping_host& x);

} // namespace rubicon::cli
