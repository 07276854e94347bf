#include "cli/print/event_lines.hpp"

#include <algorithm>
#include <utility>

#include "cli/print/progress_bar.hpp"
#include "core/text/printable.hpp"
#include "report/figures.hpp"
#include "report/print/text_layout.hpp"

namespace rubicon::cli {

std::string event_line(const report::logged_event& x, duration shift) {
  constexpr std::size_t width = 9; // below an hour
  const auto time = report::run_time(x.at + shift);
  return printable(report::blanks(time, width) + time + "  " + x.who + "  " + x.what);
}

std::string wall_progress_text(duration reached, duration end, double events_per_s,
                               std::size_t joined, std::size_t width) {
  const auto share = end > 0s ? std::clamp(seconds(reached) / seconds(end), 0.0, 1.0) : 1.0;
  auto text = report::clock_text(reached) + " of " + report::clock_text(end) + "  " +
              std::to_string(static_cast<int>(share * 100)) + "%  " +
              report::fixed(events_per_s, 0) + " events/s";
  if (joined > 0)
    text += "  " + report::counted(joined, "mote") + " joined";
  return report::cut(text, width);
}

bool rate_limiter::take() {
  return ++lines_ <= lines_max;
}

std::string rate_limiter::left_out(duration real) {
  if (real < since_ + period)
    return {};
  since_ = real;
  return finish();
}

std::string rate_limiter::finish() {
  const auto lines = std::exchange(lines_, 0);
  if (lines <= lines_max)
    return {};
  return "and " + report::counted(lines - lines_max, "more event") +
         " within a second; --csv DIR keeps all\n";
}

/// As the ecology words it.
void live_log::count(const report::logged_event& x) {
  if (x.what.starts_with("joined"))
    joined_.insert(x.who);
  else if (x.what.starts_with("left"))
    joined_.erase(x.who);
}

std::string live_log::above_progress(const std::string& lines) const {
  return lines.empty() || drawn_.empty() ? lines : std::string(erase_line) + lines + drawn_;
}

std::string live_log::add_event(duration real, const report::logged_event& x) {
  count(x);
  auto lines = rate_.left_out(real);
  if (rate_.take())
    lines += event_line(x) + '\n';
  return above_progress(lines);
}

std::string live_log::update(duration real, instant reached, instant end, std::uint64_t events) {
  const auto lines = rate_.left_out(real);
  if (!has_progress_ || (drawn_at_ && real < *drawn_at_ + redrawn_every))
    return above_progress(lines);
  const auto gone_s = drawn_at_ ? seconds(real - *drawn_at_) : seconds(real);
  const auto per_s = gone_s > 0 ? static_cast<double>(events - events_then_) / gone_s : 0;
  drawn_at_ = real;
  events_then_ = events;
  // The last column stays free: some terminals wrap as soon as it is written.
  const auto room = width_ - std::min<std::size_t>(width_, 1);
  drawn_ = wall_progress_text(reached.time_since_epoch(), end.time_since_epoch(), per_s,
                              joined_.size(), room);
  return std::string(erase_line) + lines + drawn_;
}

std::string live_log::finish() {
  const auto lines = rate_.finish();
  return std::exchange(drawn_, {}).empty() ? lines : std::string(erase_line) + lines;
}

} // namespace rubicon::cli
