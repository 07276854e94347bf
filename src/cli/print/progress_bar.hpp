// The progress of a virtual run, on a terminal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/time.hpp"

namespace rubicon::cli {

/// Terminal control: back to the first column and erase the line.
inline constexpr std::string_view erase_line = "\r\033[K";

/// `▕████▌    ▏  42%   4:12 of 10:00  714 ×  3 s left`, at most `width` characters: where space
/// is short the bar goes first, then the text from its end.
/// @param real   real time since the start
/// @param reached, end   ecology time, reached of all
[[nodiscard]] std::string progress_text(duration real, duration reached, duration end,
                                        std::size_t width);

/// Decides when to draw what. Knows neither a clock nor a terminal: it is given the real time since
/// the start and returns what to write.
class progress_bar {
public:
  static constexpr duration shown_after = 1s;
  static constexpr duration redrawn_every = 100ms;

  explicit progress_bar(std::size_t width) : width_(width) {}

  /// What to write now; empty most of the time.
  [[nodiscard]] std::string update(duration real, instant reached, instant end);

  /// What removes the bar; empty if none stands there.
  [[nodiscard]] std::string finish();

private:
  std::size_t width_;
  std::optional<duration> drawn_at_;
};

} // namespace rubicon::cli
