// What a mote's radio and MCU have used (NRG-05, docs/tinyos.md 7).
#pragma once

#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "radio/parameters.hpp"

namespace rubicon::radio {

enum class radio_state : std::uint8_t { off, listen, transmit };

/// How long a mote was in each state. While the battery lasts, the radio's four times and the MCU's
/// two each add up to the time since the meter was started, to the nanosecond.
struct energy_times {
  duration radio_off{};
  duration radio_listen{};   ///< on and neither of the next two: back-offs and ack waits as well
  duration radio_receive{};  ///< locked on a frame, for whomever it is
  duration radio_transmit{}; ///< from the first to the last octet on the air
  duration mcu_active{};     ///< platform::service_time for each frame, and long computations
  duration mcu_sleep{};

  friend bool operator==(const energy_times&, const energy_times&) = default;
};

/// What these times cost. [mAh]
struct energy_charges {
  double radio_off = 0;
  double radio_listen = 0;
  double radio_receive = 0;
  double radio_transmit = 0;
  double mcu = 0;
};

/// For each state time x current.
/// @param transmit_ma current while sending, at the power the mote sends with
[[nodiscard]] energy_charges charges_of(const energy_times& times, const platform& kind,
                                        double transmit_ma);

/// The sum of them, rounded once less: listening and receiving cost the same.
[[nodiscard]] double used_mah(const energy_times& times, const platform& kind, double transmit_ma);

/// Counts one mote's times. `now` never goes back from one call to the next. Receiving draws
/// the same current as listening (docs/tinyos.md 7.1) and is not distinguished here: the medium
/// knows it.
class energy_meter {
public:
  energy_meter() = default;
  /// @param battery_mah infinity for a mote that is fed by a cable
  /// @param transmit_dbm the power the mote sends with
  /// @pre kind is not nullptr and outlives the meter; battery_mah > 0
  energy_meter(const platform* kind, double battery_mah, double transmit_dbm, instant start);

  /// Begins anew, with a battery of which so much is used. @pre it is not stopped
  void restart(double used_mah, instant now);

  /// The radio enters a state.
  void enter(radio_state next, instant now);

  /// The MCU works for `length`, after what it already has to do.
  /// @returns when that work will be done
  instant work(duration length, instant now);

  /// The MCU computes for `length`, after what it already computes. Interrupts let it work
  /// meanwhile.
  void compute(duration length, instant now);

  /// The MCU drops the work it has not done yet.
  void drop_work(instant now);

  /// The battery is flat: nothing is booked from here on.
  void stop(instant now);

  /// radio_receive is 0, radio_listen includes it.
  [[nodiscard]] energy_times times(instant now) const;
  [[nodiscard]] double used_mah(instant now) const;
  [[nodiscard]] energy_charges charges_of(const energy_times& times) const {
    return radio::charges_of(times, *kind_, transmit_ma_);
  }

  /// When the battery will be flat if the radio stays in its state and the MCU gets no new work:
  /// instant::max() if not within 30 years, `now` or when it was stopped if it already is.
  [[nodiscard]] instant empty_at(instant now) const;

  /// The battery has more than the reserve at least until here, whatever radio and MCU do;
  /// instant::max() as above.
  [[nodiscard]] instant lasts_until(instant now, double reserve_mah = 0) const;

  [[nodiscard]] bool stopped() const { return stopped_.has_value(); }
  [[nodiscard]] radio_state state() const { return state_; }
  [[nodiscard]] double battery_mah() const { return battery_mah_; }

private:
  void extend(instant& until, instant other, duration length, instant now);
  [[nodiscard]] duration ahead(instant now) const; ///< in which the MCU is still active
  [[nodiscard]] double radio_ma(radio_state x) const;

  const platform* kind_ = nullptr;
  double battery_mah_ = 0;
  double used_before_mah_ = 0;
  double transmit_ma_ = 0;
  instant start_;
  instant since_; ///< when state_ was entered
  instant busy_until_;
  instant computes_until_;
  energy_times
      times_; ///< booked so far; mcu_active includes what is still ahead, mcu_sleep is unused
  radio_state state_ = radio_state::off;
  std::optional<instant> stopped_;
};

} // namespace rubicon::radio
