// Ecology time and timers inside actors.
#pragma once

#include <cstdint>
#include <optional>

#include <caf/actor_control_block.hpp>

#include "actors/messages/common.hpp"
#include "core/time.hpp"
#include "scheduler/process.hpp"

namespace rubicon {

/// The ecology time of the actor's scheduler: the only clock an actor may read.
template <class Self>
[[nodiscard]] instant now(Self* self) {
  return self->now();
}

/// Follows a core's deadline: at any time at most one message is pending, which moves with the
/// deadline and is taken back with the timer. One that is delivered, but not yet handled when the
/// deadline changes has an old epoch and is ignored.
class timer {
public:
  timer() = default;
  /// @param which tells the timers of one actor apart
  explicit timer(std::uint8_t which) : which_(which) {}
  ~timer() { stop(); }
  timer(const timer&) = delete;
  timer& operator=(const timer&) = delete;

  /// Sees to it that the actor gets a timer_expired at `deadline`, and none before or without one.
  /// @pre the same `self` each time, which owns the timer
  template <class Self>
  void follow(Self* self, std::optional<instant> deadline) {
    if (!deadline || *deadline == none)
      return stop();
    if (*deadline == deadline_)
      return;
    deadline_ = *deadline;
    process_ = self->where();
    if (process_->move(pending_, *deadline))
      return;
    const caf::strong_actor_ptr me(self->ctrl());
    pending_ = process_->schedule(*deadline, me,
                                  scheduler::make_envelope(timer_expired{which_, ++epoch_}));
  }

  /// No expiry is awaited any more.
  void stop() {
    if (deadline_ == none)
      return;
    deadline_ = none;
    ++epoch_;
    process_->timeouts().cancel(pending_);
  }

  /// @returns whether `x` is the expiry awaited; then follow() must be called again
  [[nodiscard]] bool accepts(const timer_expired& x) {
    if (deadline_ == none || x.which != which_ || x.epoch != epoch_)
      return false;
    deadline_ = none;
    return true;
  }

private:
  static constexpr instant none = instant::max();

  std::uint8_t which_ = 0;
  std::uint64_t epoch_ = 0; ///< of the message that is pending or not yet handled
  scheduler::process* process_ = nullptr;
  scheduler::movable_message pending_;
  instant deadline_ = none; ///< what the awaited expiry is for
};

} // namespace rubicon
