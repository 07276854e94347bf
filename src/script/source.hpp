// The text of a Lua script, and what is wrong with it before it runs (docs/lua.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace rubicon::script {

inline constexpr std::size_t source_octets_max = std::size_t{1} << 20;

struct source {
  std::string name; ///< of its file, for positions: `fan.lua`
  std::string text;
};

struct limits {
  std::uint32_t memory = 64 * 1024;     ///< octets of its heap above that of an empty script
  std::uint32_t instructions = 100'000; ///< of one event, or of the script's main part
};

/// Numbers that a file sets, in `settings` of the script.
using settings = std::map<std::string, double, std::less<>>;

struct source_problem {
  unsigned line = 0; ///< from 1; 0: of the whole text
  std::string message;
};

/// Compiles a script and runs nothing.
[[nodiscard]] std::optional<source_problem> check(const source& x, const limits& most);

/// The line of the first `^` outside of texts and comments; 0: none. The C library calculates
/// powers, with other bits on other machines.
[[nodiscard]] unsigned line_of_power(std::string_view text);

} // namespace rubicon::script
