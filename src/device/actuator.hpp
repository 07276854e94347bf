// An actuator: where it is, and how it moves to where it is sent (DIS-02).
#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "device/transducer_config.hpp"

namespace rubicon::device {

/// Moves straight to its target, at the speed of `travel` for the whole path from 0 to 255.
///
///   resting --set, not there yet--> moving --on_time at deadline()--> resting
///                                   |   ^
///              sent elsewhere (set) +---+
class actuator {
public:
  actuator() = default;
  explicit actuator(actuator_config config);

  /// Sends it to `target`, from wherever it is.
  /// @returns false if it has no such state: a relay has 0 and 1 only
  [[nodiscard]] bool set(std::uint8_t target, instant now);

  /// Where it is: rounded to the nearest of 0..255.
  [[nodiscard]] std::uint8_t state(instant now) const;

  [[nodiscard]] std::uint8_t target() const { return target_; }

  /// When it arrives; nothing while it rests.
  [[nodiscard]] std::optional<instant> deadline() const { return arrival_; }

  /// @returns true once for each movement, when it has ended; harmless before deadline()
  [[nodiscard]] bool on_time(instant now);

  [[nodiscard]] const actuator_config& config() const { return config_; }

private:
  /// The time that it takes from 0 to where it is.
  [[nodiscard]] duration travel_at(instant now) const;
  [[nodiscard]] duration travel_of(std::uint8_t state) const;

  actuator_config config_;
  std::uint8_t target_ = 0;
  duration from_{}; ///< travel_at() when it last began to move
  instant begin_;   ///< of that movement
  std::optional<instant> arrival_;
};

} // namespace rubicon::device
