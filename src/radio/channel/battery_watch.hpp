// When the battery of a mote is looked at, and what is found then.
#pragma once

#include <optional>

#include "core/time.hpp"
#include "radio/energy.hpp"

namespace rubicon::radio {

/// Share of a battery's charge that is left when its mote is warned.
inline constexpr double battery_reserve = 0.05;

/// What a mote has used so far.
struct energy_use {
  energy_times times;
  energy_charges charges;
  bool radio_on = false; ///< at this moment
  duration elapsed{};    ///< since it was added, until now or until its battery was flat
  double used_mah = 0;   ///< never above battery_mah by more than 10 ms of current
  double battery_mah = 0;
  instant empty_at; ///< if it goes on doing what it does at this moment
};

/// The battery of one radio's mote. What is drawn from it is counted by the meter.
///
///   full --battery_reserve is left--> low --nothing is left, or run_down()--> flat
class battery_watch {
public:
  struct finding {
    bool runs_low = false; ///< since the last look
    bool is_flat = false;  ///< run_down() is to follow
  };

  /// It is there, and counted, from now on.
  void begin(instant now);

  /// When to look again: until then it does not come to its reserve or, if it is low, to its end,
  /// whatever radio and MCU do. It is not looked at twice in 10 ms. Nothing if it never ends.
  [[nodiscard]] std::optional<instant> next_look(const energy_meter& meter, instant now);
  [[nodiscard]] finding look(const energy_meter& meter, instant now);

  /// It is flat.
  void run_down(instant now);

  /// @param times of the meter, with the time in reception
  [[nodiscard]] energy_use use(const energy_meter& meter, const energy_times& times,
                               instant now) const;

  /// At least, as found by the last next_look(): instant::max() if it never ends, or is flat.
  [[nodiscard]] instant lasts_until() const { return lasts_until_; }

private:
  instant begun_at_;
  bool runs_low_ = false; ///< its owner knows
  instant lasts_until_ = instant::max();
  instant flat_at_ = instant::max();
};

} // namespace rubicon::radio
