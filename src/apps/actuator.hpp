// Lets its gateway command an actuator of its mote.
#pragma once

#include <cstdint>

#include "apps/application.hpp"

namespace rubicon::apps {

/// Obeys the first octet of what it receives, and tells the actuator's state after every change and
/// when its mote has joined.
class actuator final : public application {
public:
  /// @param state of the actuator when its mote starts
  actuator(actuator_config config, std::uint8_t state)
      : config_(std::move(config)), state_(state) {}

  void joined(communication::island_octet island, std::uint16_t mote,
              communication::status success) override;
  void receiveFrom(mote_address source, byte_view octets, std::uint8_t am_type) override;
  void actuatorChanged(std::string_view name, std::uint8_t state, bool obeyed) override;

private:
  void on_start(instant now) override;
  void tell_state();

  actuator_config config_;
  std::uint8_t state_ = 0;
};

} // namespace rubicon::apps
