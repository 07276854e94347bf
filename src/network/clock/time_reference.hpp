// What the root of an island knows of the time outside: it asks its gateway over the serial line
// for the time that peers share (CLK-08).
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "core/describe/fields.hpp"
#include "core/time.hpp"

namespace rubicon::network {

struct time_reference_config {
  duration gap = 10s;      ///< between two requests
  duration gap_first = 1s; ///< between the first ones, and after an answer that was not good enough
  unsigned first = 4;      ///< requests, and good answers, in the beginning
  static constexpr unsigned repeats_max = 4; ///< requests in a row without a good answer
  duration answer_max = 1s;                  ///< an answer that comes later is ignored

  /// A good answer's round trip exceeds the shortest of the last ones by no more than this.
  static constexpr duration excess_max = 1ms;
  /// An answer farther from the line means that the time there was set, or the answer is wrong.
  static constexpr duration leap_min = 2ms;
  static constexpr duration span_min = 10s;   ///< of the answers from which drift is estimated
  static constexpr duration spread = 60s;     ///< between answers that are kept, but the newest
  static constexpr double drift_max = 600e-6; ///< two crystals drift apart by less
};

struct time_reference_counters {
  std::uint64_t asked = 0;
  std::uint64_t answered = 0; ///< = good + slow + doubtful
  std::uint64_t good = 0;
  std::uint64_t slow = 0;     ///< its round trip was too long: something was in the line's queues
  std::uint64_t doubtful = 0; ///< far off the line, and the next one did not agree
  std::uint64_t strays = 0;   ///< answers to no question, or to an earlier one
  std::uint64_t leaps = 0;    ///< lines begun anew
};
RUBICON_FIELDS(time_reference_counters, asked, answered, good, slow, doubtful, strays, leaps);

/// Two-way exchanges, as NTP and PTP have them. Question and answer are equally long, and each end
/// says how long its own line kept it waiting, so that a good answer was true in the middle between
/// them: what the shortest round trip of late does not explain was spent elsewhere on the line, and
/// half of it is the most that the middle is wrong.
/// A straight line through the last good answers gives offset and drift; it lasts while no answer
/// comes, whose questions are not asked more often for that. An answer far off the line is ignored,
/// two in succession that agree start a new line.
///
/// All instants are of our own clock.
class time_reference {
public:
  static constexpr std::size_t answers_max = 8;

  time_reference() = default;
  time_reference(time_reference_config config, instant now);

  /// Our own clock has leapt forward by so much, or back: its owner's timers have not.
  void on_clock_leapt(duration by);

  /// Harmless before deadline(). @returns the number of the question that is to be asked now
  [[nodiscard]] std::optional<std::uint16_t> on_time(instant now);
  [[nodiscard]] instant deadline() const { return next_; }

  /// The line was in use: the question leaves so much later than on_time() returned its number.
  void on_delayed(duration by);

  /// @param since_1970 when the question came there
  /// @param held so much later the answer left
  void on_answer(std::uint16_t number, duration since_1970, instant now, duration held = {});

  /// The time there, since 1970; nothing before the first answer.
  [[nodiscard]] std::optional<duration> at(instant own) const;

  /// By how much our clock is too slow: 1e-6 is 1 ppm; nothing: not known yet.
  [[nodiscard]] std::optional<double> drift() const {
    return has_drift_ ? std::optional(drift_) : std::nullopt;
  }
  [[nodiscard]] const time_reference_counters& counters() const { return counters_; }

private:
  struct answer {
    instant own; ///< in the middle between question and answer
    duration ahead{};
    duration round_trip{};
  };

  [[nodiscard]] duration ahead(instant own) const;
  [[nodiscard]] bool is_good(duration round_trip);
  [[nodiscard]] bool agrees(const answer& x);
  [[nodiscard]] duration shortest_good() const; ///< @pre there are good ones
  void fit();
  void ask_again(instant now);

  time_reference_config config_;
  std::uint16_t number_ = 0;         ///< of the last question,
  std::optional<instant> asked_;     ///< if it waits for its answer
  std::deque<answer> answers_;       ///< good ones
  std::deque<duration> round_trips_; ///< of the last answers, good or not
  std::optional<answer> doubtful_;   ///< the last answer, if it was far off
  instant middle_;                   ///< of the good answers,
  duration middle_ahead_{};          ///< where the line goes through
  double drift_ = 0;                 ///< its slope,
  bool has_drift_ = false;           ///< if it is known
  unsigned repeats_ = 0;
  instant next_;
  time_reference_counters counters_;
};

} // namespace rubicon::network
