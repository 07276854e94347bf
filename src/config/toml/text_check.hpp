// What must be sorted out before the TOML parser sees a text.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "config/toml/problem.hpp"

namespace rubicon::config {

/// Each dot of a key opens a table, which the parser builds and destroys recursively.
inline constexpr std::size_t key_dots_max = 64;

/// The first place where a key has more dots than that. Exact in well-formed text; behind a syntax
/// error it may be wrong, but there the parser reads no further.
[[nodiscard]] std::optional<mark> overlong_key(std::string_view text);

} // namespace rubicon::config
