// Ecology time and timers inside actors.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include <caf/actor_clock.hpp>
#include <caf/actor_system.hpp>

#include "actors/messages.hpp"
#include "core/time.hpp"

namespace rubicon {

/// The ecology time of the actor's scheduler: the only clock an actor may read.
template <class Self>
[[nodiscard]] instant now(Self* self) {
  return instant(self->system().clock().now().time_since_epoch());
}

/// Follows a core's deadline. CAF cannot cancel a delayed message, so one that is no longer awaited
/// has an old epoch and is ignored. A deadline that moves away does not cost a new message: the
/// earlier wake-up comes, which cores take for harmless, and the timer is set again after it.
class timer {
public:
  timer() = default;
  /// @param which tells the timers of one actor apart
  explicit timer(std::uint8_t which) : which_(which) {}

  /// Sees to it that the actor gets a timer_expired at `deadline` at the latest.
  template <class Self>
  void follow(Self* self, std::optional<instant> deadline) {
    if (!deadline || (wake_ && *wake_ <= *deadline))
      return;
    const auto time = std::max(*deadline, now(self));
    wake_ = time;
    ++epoch_;
    self->scheduled_send(self, caf::actor_clock::time_point(time.time_since_epoch()),
                         timer_expired{which_, epoch_});
  }

  /// No expiry is awaited any more.
  void stop() {
    wake_.reset();
    ++epoch_;
  }

  /// @returns whether `x` is the expiry awaited; then follow() must be called again
  [[nodiscard]] bool accepts(const timer_expired& x) {
    if (!wake_ || x.which != which_ || x.epoch != epoch_)
      return false;
    wake_.reset();
    return true;
  }

private:
  std::uint8_t which_ = 0;
  std::uint64_t epoch_ = 0;
  std::optional<instant> wake_; ///< when the awaited expiry comes
};

} // namespace rubicon
