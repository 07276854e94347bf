// Passwords and the like, which are read where they are used and are in no report, log or record.
#pragma once

#include <string>
#include <variant>

namespace rubicon::io {

/// Why there is none; without anything of its content.
struct no_secret {
  std::string reason;
};

/// The first line of a regular file of up to 4096 octets to which no other user has access.
[[nodiscard]] std::variant<std::string, no_secret> read_secret(const std::string& path);

/// The value of an environment variable.
[[nodiscard]] std::variant<std::string, no_secret> secret_in_environment(const char* name);

} // namespace rubicon::io
