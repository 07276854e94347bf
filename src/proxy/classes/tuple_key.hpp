// The keys of a proxy's own tuples.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/tuples/tuple_key.hpp"

namespace rubicon::proxy {

/// Whose proxy it is.
struct proxy_identity {
  mote_address mote;
  std::string island_name;         ///< empty: the island's decimal id stands for it
  std::string mote_name;           ///< empty: `mote-7`, for a mote that no file describes
  std::string interface_name = {}; ///< of what perceives it, its gateway; empty: not known
  std::optional<position> interface_place = {}; ///< where that is, if it is known (PXY-06)
};

/// One part of a key: letters, digits, `-` and `_` stay, every other octet becomes `_`; so a name
/// with a dot or a `*` neither splits the key nor makes it a wildcard. Empty text becomes `_`.
[[nodiscard]] std::string key_part(std::string_view text);

/// Several parts between dots, each as in key_part().
[[nodiscard]] std::string key_parts(std::string_view text);

/// The names that the tuples of a mote's proxy show, as texts, in the order of their placeholders:
/// island, id, name.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> names_of(const proxy_identity& who);

/// Replaces {island}, {id} and {name} in a class's prefix; what they stand for is always within one
/// part. Anything else in braces becomes part of the key as key_part() has it.
[[nodiscard]] std::string key_prefix(std::string_view prefix, const proxy_identity& who);

/// The same with other names: each pair is what stands in braces, `{id}`, and its one part.
[[nodiscard]] std::string
fill_prefix(std::string_view prefix,
            const std::vector<std::pair<std::string_view, std::string>>& names);

/// Keys are compared without letter case (TUP-03).
[[nodiscard]] bool same_key(std::string_view a, std::string_view b);

} // namespace rubicon::proxy
