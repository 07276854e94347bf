// Columns for a terminal: text is measured in characters, not octets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/text/printable.hpp"

namespace rubicon::report {

/// Characters of UTF-8 text, each counted as one column.
[[nodiscard]] std::size_t display_width(std::string_view x);

using rubicon::printable;

/// At most `width` characters of `x`; what is cut off shows as `…`.
[[nodiscard]] std::string cut(std::string_view x, std::size_t width);

/// What is missing from `x` to `width` characters; nothing if it is as wide.
[[nodiscard]] std::string blanks(std::string_view x, std::size_t width);

enum class look : std::uint8_t { plain, strong, faint, good, bad };

/// `x` between the ANSI escapes of `how`, or as it is without `colour`.
[[nodiscard]] std::string painted(std::string_view x, look how, bool colour);

enum class align : std::uint8_t {
  left,
  right,
  point, ///< numbers one above the other at their decimal points; other text to the left
};

struct cell {
  cell(std::string x = {}, look y = look::plain) : text(std::move(x)), how(y) {} // NOLINT: implicit
  cell(const char* x) : text(x) {}                                               // NOLINT

  std::string text;
  look how = look::plain;
};

/// Rows under a faint heading, each column as wide as its widest cell. When a row would not fit,
/// the widest column is narrowed, and in the end columns are left out, which a note names.
class table {
public:
  struct column {
    std::string heading;
    align where = align::left;
  };

  explicit table(std::vector<column> columns) : columns_(std::move(columns)) {}

  /// @pre not more cells than columns; missing ones stay empty
  void add(std::vector<cell> row);

  /// A line of its own below the last row, over all columns; cut at the width.
  void add_note(std::string_view text, look how = look::faint);

  [[nodiscard]] bool empty() const { return rows_.empty(); }

  /// Lines with a newline each, indented by two characters. Columns without any text are left out.
  [[nodiscard]] std::string render(std::size_t width, bool colour) const;

private:
  struct line {
    std::vector<cell> cells;
    bool is_note = false; ///< then the only cell holds it
  };

  [[nodiscard]] std::vector<line> aligned() const;
  [[nodiscard]] std::vector<std::size_t> natural_widths(const std::vector<line>& lines) const;
  [[nodiscard]] bool narrow(std::vector<std::size_t>& wide, std::size_t width) const;
  [[nodiscard]] std::vector<std::size_t> widths(const std::vector<line>& lines,
                                                std::size_t width) const;

  std::vector<column> columns_;
  std::vector<line> rows_;
};

} // namespace rubicon::report
