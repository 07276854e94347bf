// What must be sorted out before the TOML parser sees a text.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "config/problem.hpp"

namespace rubicon::config {

/// Each dot of a key opens a table, which the parser builds and destroys recursively.
inline constexpr std::size_t key_dots_max = 64;

/// The first thing in a text that toml++ 3.3 cannot be given: a character beyond ASCII outside of
/// strings and comments, where TOML has none and the parser's behaviour is undefined, or a key with
/// more than key_dots_max dots.
[[nodiscard]] std::optional<std::pair<mark, std::string>> unparsable(std::string_view text);

} // namespace rubicon::config
