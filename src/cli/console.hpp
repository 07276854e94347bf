// Where text goes to: a terminal of some width, or a file or pipe.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string_view>

namespace rubicon::cli {

struct console {
  bool is_terminal = false;
  bool colour = false;     ///< a terminal that wants it: no NO_COLOR, TERM not `dumb`
  std::size_t width = 100; ///< characters; a terminal's own where it tells
};

[[nodiscard]] console console_of(std::FILE* stream);

/// Writes and flushes. @returns false if not everything could be written
[[nodiscard]] bool print(std::FILE* stream, std::string_view text);

} // namespace rubicon::cli
