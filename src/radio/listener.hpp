// When a radio that listens at low power is on.
#pragma once

#include <cstdint>

#include "core/time.hpp"
#include "radio/parameters.hpp"

namespace rubicon::radio {

/// Sans-I/O; it knows neither medium nor medium access: BoX-MAC-2's receiver as TinyOS has it (Moss
/// and Levis, BoX-MACs, SING-08-00; TEP 105).
///
///   asleep --next check--> checking --something was on the air--> awake --quiet for so long--+
///     ^  |                    |  |                                 ^  ^                      |
///     |  |                    |  +----- a frame to be sent --------+  |                      |
///     |  +--------------------|-------- a frame to be sent -----------+                      |
///     +-----------------------+--nothing                                                     |
///     +--------------------------------------------------------------------------------------+
///
/// Checks begin at equal gaps, whatever comes in between; those that would begin while it is awake
/// are left out.
class listener {
public:
  enum class state : std::uint8_t { awake, checking, asleep };

  listener() = default;

  /// It is awake at first.
  /// @param first a moment at which a check would begin @pre config.enabled()
  listener(const listening_config& config, instant first, instant now);

  /// Deadline or not, it is to be awake from now on for a while.
  /// @returns whether the radio was asleep, and deadline() is another
  bool stay_awake(instant now);

  /// @param was_busy whether the channel has been busy since checked_from(); matters only while
  /// checking
  /// @param busy it is sending, receiving or about to answer: the radio cannot be switched off
  void on_time(instant now, bool was_busy, bool busy);

  [[nodiscard]] state now_in() const { return state_; }
  [[nodiscard]] bool is_on() const { return state_ != state::asleep; }
  [[nodiscard]] instant checked_from() const { return since_; }

  /// When on_time() is due. While it stays awake for longer than that, on_time() finds it so.
  [[nodiscard]] instant deadline() const { return deadline_; }

private:
  void sleep(instant now);

  listening_config config_;
  state state_ = state::awake;
  instant first_;
  instant since_;       ///< when the check began
  instant awake_until_; ///< at least
  instant deadline_;
};

} // namespace rubicon::radio
