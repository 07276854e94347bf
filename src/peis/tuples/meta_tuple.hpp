// Meta tuples: values that name another tuple (peis-wire.md 17, META-01 to META-04).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/address.hpp"
#include "core/error.hpp"
#include "peis/tuples/key.hpp"
#include "peis/tuples/tuple.hpp"

namespace rubicon::peis {

inline constexpr std::string_view meta_mimetype = "x-peis/metatuple";

/// What a meta tuple points at.
struct meta_target {
  peer_id owner;
  key name;

  friend bool operator==(const meta_target&, const meta_target&) = default;
};

/// Unset: it points nowhere.
using meta_reference = std::optional<meta_target>;

/// Reads `(META <owner> <key>)`; blanks between the words are free, the closing parenthesis may
/// follow the key directly or be missing. Owner -1 points nowhere, whatever the key. Anything else,
/// a pattern as key included, is a bad_value.
[[nodiscard]] result<meta_reference> parse_meta(std::string_view text);

/// `(META -1 NULL)` for a reference that points nowhere.
[[nodiscard]] std::string format_meta(const meta_reference& x);

/// What a meta tuple's value is to be.
[[nodiscard]] tuple_content meta_content(const meta_reference& x);

/// The reference in a tuple; bad_value also for other MIME types.
[[nodiscard]] result<meta_reference> read_meta(const tuple& x);

/// The key of the meta tuple that configures a component's input: `mi-x` for `x`, `a.mi-b` for
/// `a.b`.
[[nodiscard]] std::string meta_key_of(std::string_view input);

} // namespace rubicon::peis
