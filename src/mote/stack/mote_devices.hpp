// What a mote measures and moves.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/numbers/random.hpp"
#include "core/shared_list.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "device/actuator.hpp"
#include "device/transducer.hpp"
#include "device/transducer_config.hpp"

namespace rubicon::mote {

/// An actuator has come to where it was sent.
struct actuator_arrived {
  std::string name;
  std::uint8_t state = 0;
};

/// Transducers and actuators of one mote, and how strongly it receives its parent.
class mote_devices {
public:
  /// No frame of a parent has come yet; no radio receives that much.
  static constexpr std::int16_t signal_unknown = 127;

  /// @param who place, and seed of random walks
  mote_devices(shared_list<device::transducer_config> transducers,
               const shared_list<device::actuator_config>& actuators, device::reader who);

  /// The mote is somewhere else from now on.
  void move(position x) { who_.place = x; }

  /// One reading, as a count; nothing if the mote has no such transducer. Of
  /// device::quantity::signal the newest frame of its parent, or signal_unknown.
  /// @param now by the world's time
  [[nodiscard]] std::optional<std::int16_t> read(device::quantity kind, instant now,
                                                 random_stream& rng) const;

  void set_parent_dbm(std::int16_t x) { parent_dbm_ = x; }
  [[nodiscard]] std::int16_t parent_dbm() const { return parent_dbm_; } ///< or signal_unknown

  /// Where an actuator is; nothing: there is no such actuator.
  [[nodiscard]] std::optional<std::uint8_t> state(const std::string& name, instant now) const;

  /// @returns false: there is no such actuator, or it has no such state
  [[nodiscard]] bool set(const std::string& name, std::uint8_t target, instant now);

  [[nodiscard]] std::vector<actuator_arrived> on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  shared_list<device::transducer_config> transducers_;
  device::reader who_;
  std::int16_t parent_dbm_ = signal_unknown; ///< of its newest frame
  small_map<std::string, device::actuator> actuators_;
};

} // namespace rubicon::mote
