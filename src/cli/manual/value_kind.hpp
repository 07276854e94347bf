// How the values of keys are written in a file: what docs/configuration.md says of kinds, for
// texts.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "config/toml/schema.hpp"

namespace rubicon::cli {

/// A kind of value with units.
struct value_kind {
  std::string_view name;   ///< the first word of what a key may be: `time`
  std::string_view sample; ///< as a file would write it
  std::string_view units;  ///< separated by commas
};

[[nodiscard]] std::span<const value_kind> kinds_with_units();

/// The one of a key; nullptr: a kind without units.
[[nodiscard]] const value_kind* kind_of(const config::key_description& x);

/// A value that the key may have, as a file would write it: its default, if it has one.
/// @pre it is no table
[[nodiscard]] std::string sample_of(const config::key_description& x);

/// Markdown without links, code marks and escapes.
[[nodiscard]] std::string plain_text(std::string_view markdown);

/// What a key may be.
[[nodiscard]] std::string range_text(const config::key_description& x);

/// What holds without it: `required`, `default: "4s"`, or empty.
[[nodiscard]] std::string default_text(const config::key_description& x);

} // namespace rubicon::cli
