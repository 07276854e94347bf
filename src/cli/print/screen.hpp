// A terminal that one program fills, picture after picture, and leaves as it was.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <termios.h>

namespace rubicon::cli {

/// Whether standard output can be filled: a terminal that knows more than lines.
[[nodiscard]] bool has_screen();

/// The terminal's other screen, without cursor and echo of keys, until it is destroyed. Ctrl-C
/// stays a signal.
class screen {
public:
  screen();
  ~screen();
  screen(const screen&) = delete;
  screen& operator=(const screen&) = delete;

  /// Lines of text in the place of those that are there. @returns false if nobody takes them
  [[nodiscard]] bool draw(std::string_view text) const;

  /// A key that was pressed since; nothing if none was, or there is no keyboard.
  [[nodiscard]] std::optional<char> key() const;

  [[nodiscard]] std::size_t width() const;
  [[nodiscard]] std::size_t height() const;

private:
  std::optional<termios> before_; ///< of the keyboard; unset: it is none of ours
};

} // namespace rubicon::cli
