// Radios, frames and channels that several tests of the room use.
#pragma once

#include <cstdint>

#include "radio/energy.hpp"
#include "radio/frame.hpp"
#include "radio/mac_rules.hpp"
#include "radio/parameters.hpp"

namespace rubicon::test {

inline const radio::platform& micaz = *radio::find_platform("micaz");
inline const radio::mac_rules* const standard = radio::find_mac("standard", micaz);

[[nodiscard]] inline mote_address mote(unsigned id, unsigned pan = 1) {
  return {island_id{pan}, mote_id{static_cast<std::uint16_t>(id)}};
}

[[nodiscard]] inline radio::frame frame_for(std::uint16_t destination, std::uint16_t pan = 1,
                                            std::uint16_t source = 9, std::uint8_t dsn = 0) {
  radio::frame x;
  x.destination = mote_id{destination};
  x.pan = pan;
  x.source = mote_id{source};
  x.dsn = dsn;
  return x;
}

[[nodiscard]] inline radio::channel_config disk(double range_m, double loss = 0) {
  radio::channel_config x;
  x.propagation = radio::unit_disk{range_m};
  x.loss = loss;
  return x;
}

[[nodiscard]] inline duration radio_sum(const radio::energy_times& x) {
  return x.radio_off + x.radio_listen + x.radio_receive + x.radio_transmit;
}

} // namespace rubicon::test
