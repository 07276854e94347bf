#include "cli/print/progress_bar.hpp"

#include <algorithm>
#include <array>
#include <chrono>

#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

namespace {

constexpr std::size_t bar_width_max = 20;
constexpr std::size_t bar_width_min = 8;

double done_share(duration reached, duration end) {
  if (end <= 0s)
    return 1;
  return std::clamp(seconds(reached) / seconds(end), 0.0, 1.0);
}

/// A bar in eighths of a character.
std::string bar(double share, std::size_t width) {
  static constexpr std::array<const char*, 8> eighths{"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const auto filled = static_cast<std::size_t>(share * static_cast<double>(8 * width));
  std::string text = "▕";
  for (std::size_t i = 0; i < filled / 8; ++i)
    text += "█";
  text += eighths[filled % 8];
  const auto used = (filled + 7) / 8;
  return text + std::string(width - used, ' ') + "▏ ";
}

/// As wide as that of `longest`, so that nothing moves while time goes on.
std::string clock_text(duration x, duration longest) {
  const auto text = report::clock_text(x);
  return report::blanks(text, report::clock_text(longest).size()) + text;
}

std::string time_left(duration real, double share) {
  if (share <= 0)
    return "–";
  const auto left_s = seconds(real) * (1 - share) / share;
  return (left_s < 60 ? report::fixed(left_s, 0) + " s" : report::real_time(left_s)) + " left";
}

} // namespace

std::string progress_text(duration real, duration reached, duration end, std::size_t width) {
  const auto share = done_share(reached, end);
  const auto whole_percent = std::to_string(static_cast<int>(share * 100)) + '%';
  const auto text = report::blanks(whole_percent, 5) + whole_percent + "  " +
                    clock_text(reached, end) + " of " + clock_text(end, end) + "  " +
                    report::speed_factor(reached, seconds(real)) + "  " + time_left(real, share);
  const auto frame = report::display_width(bar(0, 0));
  const auto used = report::display_width(text) + frame;
  if (used + bar_width_min > width)
    return report::cut(text, width);
  return bar(share, std::min(bar_width_max, width - used)) + text;
}

std::string progress_bar::update(duration real, instant reached, instant end) {
  if (real < shown_after || (drawn_at_ && real < *drawn_at_ + redrawn_every))
    return {};
  drawn_at_ = real;
  // The last column stays free: some terminals wrap as soon as it is written.
  const auto room = width_ - std::min<std::size_t>(width_, 1);
  return std::string(erase_line) +
         progress_text(real, reached.time_since_epoch(), end.time_since_epoch(), room);
}

std::string progress_bar::finish() {
  if (!drawn_at_)
    return {};
  drawn_at_.reset();
  return std::string(erase_line);
}

} // namespace rubicon::cli
