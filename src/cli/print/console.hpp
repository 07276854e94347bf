// Where text goes to: a terminal of some width, or a file or pipe.
#pragma once

#include <cstddef>
#include <cstdio>
#include <limits>
#include <string_view>

#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

struct console {
  bool is_terminal = false;
  bool colour = false;     ///< a terminal that wants it: no NO_COLOR, TERM not `dumb`
  bool cuts = true;        ///< what is wider is cut; a file without COLUMNS takes all
  std::size_t width = 100; ///< characters; a terminal's own where it is known, COLUMNS of a pipe

  /// Characters that a line may have.
  [[nodiscard]] std::size_t room() const {
    return cuts ? width : std::numeric_limits<std::size_t>::max();
  }
};

[[nodiscard]] console console_of(std::FILE* stream);

/// Writes and flushes. @returns false if not everything could be written
[[nodiscard]] bool print(std::FILE* stream, std::string_view text);

/// A line on standard error, made printable.
void say(std::string_view text);

/// `rubicon: WHY` on standard error. @returns exit_status::refused
exit_status refuse(std::string_view why);

} // namespace rubicon::cli
