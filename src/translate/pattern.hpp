// Keys with `*` parts, and keys made of what these stand for.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rubicon::translate {

/// What each `*` of the pattern stands for in the key, in the key's spelling; nothing if the key
/// does not match. Parts are compared without letter case (TUP-03).
[[nodiscard]] std::optional<std::vector<std::string>> match(std::string_view pattern,
                                                            std::string_view key);

/// How many `*` parts a pattern has.
[[nodiscard]] std::size_t stars_in(std::string_view pattern);

/// Whether `to` is a key in which {1} to {stars} may stand: 1 to 7 parts, each of letters, digits,
/// `-`, `_` and these.
[[nodiscard]] bool is_target(std::string_view to, std::size_t stars);

/// The key with {n} replaced. @pre is_target(to, parts.size())
[[nodiscard]] std::string filled(std::string_view to, const std::vector<std::string>& parts);

/// A key's spelling that all its spellings have in common.
[[nodiscard]] std::string folded_key(std::string_view key);

} // namespace rubicon::translate
