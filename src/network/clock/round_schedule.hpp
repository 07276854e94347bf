// When the root of an island sends the rounds of its clock, and how long it listens before the
// first one (CLK-01, CLK-04).
#pragma once

#include <optional>

#include "core/time.hpp"

namespace rubicon::network {

/// After first_rounds each gap is twice as long as the one before, up to `period` or what a mote
/// has requested, but period_least at least. A request holds for request_hold.
struct round_config {
  duration period_first = 1s; ///< between rounds after the root's start or a change
  static constexpr unsigned first_rounds = 4;
  duration period = 1min;
  duration period_least = 10s;
  static constexpr duration request_hold = 15min;

  /// A root that starts listens so long for the time it had before, or so long after an answer.
  duration resume_wait = 3s;
  static constexpr duration resume_more = 300ms;
};

/// A root's:
///
///   listening --resume_wait, or resume_more after an answer--> running: a round at each deadline()
///
/// Other motes have none, and no deadline().
class round_schedule {
public:
  round_schedule() = default;
  /// Not of a root.
  explicit round_schedule(round_config config) : config_(config) {}
  /// Of a root that begins to listen.
  round_schedule(round_config config, instant now);

  [[nodiscard]] bool is_listening() const { return listening_until_.has_value(); }
  [[nodiscard]] std::optional<instant> deadline() const { return next_; }
  [[nodiscard]] bool is_due(instant now) const { return next_ && now >= *next_; }

  /// One who knows the time has answered: what else there is comes soon.
  void on_answer(instant now);
  void stop_listening() { listening_until_.reset(); }

  /// A round begins at once, and others follow soon: who misses one receives another. So they do
  /// anyway once the root no longer listens.
  void restart(instant now);
  /// The same if a mote's time has been found to be another, not too often.
  void restart_for_dispute(instant now);

  /// A mote needs rounds so often.
  void request(duration period, instant now);

  /// One has begun now.
  void advance(instant now);

private:
  round_config config_;
  std::optional<instant> next_;
  std::optional<instant> listening_until_;
  unsigned rounds_ = 0; ///< since restart()
  duration gap_{};      ///< to the next one
  std::optional<duration> requested_;
  instant requested_until_;
  std::optional<instant> disputed_; ///< when a mote's time was last found to be another
};

} // namespace rubicon::network
