// What a file that is deployed may reach on a host: nothing but what the host allows.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/plan/ecology.hpp"

namespace rubicon::deploy {

struct host_access {
  bool commands = false; ///< components may be started as programs
  /// Patterns of paths and of Bluetooth adapters, as a shell has them; `*` is any text.
  std::vector<std::string> devices;
  bool firmware = false; ///< shared libraries that were sent may run in motes
};

/// Relative, and not above or beside where it starts: `readings/kitchen.csv`.
[[nodiscard]] bool is_inside(std::string_view path);

/// Whether one of the patterns has it. A path with `..` in it is in none.
[[nodiscard]] bool is_allowed(std::string_view device, const std::vector<std::string>& patterns);

/// Paths that a part writes, of its own folder.
[[nodiscard]] std::vector<std::string> files_written(const config::ecology_description& part);

/// What a part asks for and is not allowed, in words.
[[nodiscard]] std::vector<std::string> refusals(const config::ecology_description& part,
                                                const host_access& access);

/// The same of firmware alone, which also runs where nothing else of a file has effect: in virtual
/// time. Empty: nothing.
[[nodiscard]] std::string firmware_refusal(const config::ecology_description& part,
                                           const host_access& access);

} // namespace rubicon::deploy
