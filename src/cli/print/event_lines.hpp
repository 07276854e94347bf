// The events of a run on a terminal: a line for each event of its log, and below them the
// progress of a run in wall time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "core/time.hpp"
#include "report/report.hpp"

namespace rubicon::cli {

/// `0:00:12.004  kitchen/fan  joined`, without its end: one line that no terminal takes for more.
/// @param shift added to the event's time, of parts that begin later than the whole
[[nodiscard]] std::string event_line(const report::logged_event& x, duration shift = {});

/// `  1:05 of 10:00  11%  1,204 events/s  12 joined`, at most `width` characters. Events are all
/// deliveries to actors, not lines of the log.
/// @param reached, end   ecology time, reached of all
[[nodiscard]] std::string wall_progress_text(duration reached, duration end, double events_per_s,
                                             std::size_t joined, std::size_t width);

/// Limits lines to lines_max in a period, and counts those that were left out.
class rate_limiter {
public:
  static constexpr std::uint64_t lines_max = 50;
  static constexpr duration period = 1s;

  /// @returns whether a line may be written at `real`. @pre left_out(real) was called before
  [[nodiscard]] bool take();

  /// The note on lines that were left out in a period that is over; empty: none, or returned
  /// before. @param real since the start, ascending
  [[nodiscard]] std::string left_out(duration real);
  /// The note on the current period.
  [[nodiscard]] std::string finish();

private:
  duration since_{};
  std::uint64_t lines_ = 0;
};

/// Decides what to write of a run in wall time. Knows neither a clock nor a terminal: it is given
/// the real time since the start and returns what to write.
class live_log {
public:
  static constexpr duration redrawn_every = 500ms;

  /// @param has_progress there is a terminal, and a line below the others is updated
  live_log(bool has_progress, std::size_t width) : has_progress_(has_progress), width_(width) {}

  /// The event's line, if it is not one of too many, in the place of the progress, which stands
  /// below it again.
  [[nodiscard]] std::string add_event(duration real, const report::logged_event& x);

  /// The progress, and how many events were too many; empty most of the time.
  /// @param events delivered to actors so far
  [[nodiscard]] std::string update(duration real, instant reached, instant end,
                                   std::uint64_t events);

  /// What removes the progress, and says what was left out; empty if there is neither.
  [[nodiscard]] std::string finish();

private:
  void count(const report::logged_event& x);
  [[nodiscard]] std::string above_progress(const std::string& lines) const;

  bool has_progress_;
  std::size_t width_;
  rate_limiter rate_;
  std::set<std::string> joined_; ///< of the motes of the ecology, those that a gateway lists
  std::optional<duration> drawn_at_;
  std::uint64_t events_then_ = 0; ///< at drawn_at_
  std::string drawn_;             ///< the line that stands there
};

} // namespace rubicon::cli
