// The RUBICON clock: the tick at which the Learning Layer computes, the same T on all motes at the
// same time (D1.1 4.2.2, 5.3.1; CLK-02, CLK-05, SYN-11).
#pragma once

#include <cstdint>
#include <optional>

#include "core/island_time.hpp"
#include "core/time.hpp"

namespace rubicon::synaptic {

/// Turns a shared time that is corrected now and then into ticks that follow each other one by one.
/// A correction of less than half a period only makes one tick shorter or longer; a larger one is a
/// leap: T goes on from where the shared time says, and that is reported.
class rubicon_clock {
public:
  struct tick {
    std::uint32_t number = 0; ///< T
    bool leapt = false;       ///< it does not follow the last one (CLK-05)
  };

  /// What the shared time is now, and when it ticks; to be called at deadline(), and whenever the
  /// shared time has been corrected or `setting` has changed.
  /// @returns the tick that is due; at most one, deadline() is then that of a further one
  [[nodiscard]] std::optional<tick> update(instant now, island_time shared,
                                           const tick_setting& setting);

  /// Ticks are not needed; the next update() begins anew. That is no leap.
  void stop() { due_.reset(); }

  [[nodiscard]] std::optional<instant> deadline() const { return due_; }
  [[nodiscard]] std::uint64_t leaps() const { return leaps_; }

private:
  std::optional<std::int64_t> last_; ///< T of the last tick, or of the one before the first
  std::optional<instant> due_;
  std::uint64_t leaps_ = 0;
};

} // namespace rubicon::synaptic
