// A TOML file as pieces that may be left out: tables, their entries, and elements of arrays. Knows
// the layout of the language, not what any key means.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rubicon::study {

enum class piece_kind : std::uint8_t {
  comment, ///< also an empty line
  table,   ///< its header, its entries and the tables within it
  entry,   ///< `key = value`
  element, ///< of the array that is the value of an entry
};

/// Octets of a text.
struct piece {
  piece_kind what = piece_kind::comment;
  std::string path; ///< of a table; of an entry and its elements with the key: `fault.at`
  std::size_t begin = 0;
  std::size_t end = 0;       ///< behind the newline, or the comma
  std::size_t value = 0;     ///< of an entry: where its value begins
  std::size_t parent = npos; ///< the piece that it is in

  static constexpr auto npos = static_cast<std::size_t>(-1);
};

/// In the order of the text, parents before what is in them. A text that is no TOML has some
/// pieces, too.
[[nodiscard]] std::vector<piece> outline_of(std::string_view text);

} // namespace rubicon::study
