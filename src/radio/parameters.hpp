// What a file may say about the air and about the radios in it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/time.hpp"

namespace rubicon::radio {

/// The medium: who hears whom, and how often a copy is lost.
struct channel_config {
  double range_m = 30;      ///< unit disk: a radio farther away hears nothing
  double loss = 0;          ///< chance that one copy of a frame is lost, per receiver, 0..1
  std::size_t queue = 8;    ///< frames a radio's transmit queue holds; more are refused and counted
  unsigned retries_max = 3; ///< macMaxFrameRetries, IEEE 802.15.4-2006 table 86
};

/// Currents and limits of a kind of mote (tinyos.md 8.1, 10).
struct platform {
  std::string_view name;
  double mcu_active_ma;
  double mcu_sleep_ma;
  double radio_off_ma;
  double radio_listen_ma; ///< also while receiving (tinyos.md 8.1)
  double radio_transmit_ma;
  double supply_v;
  double battery_mah;        ///< two AA cells (tinyos.md 8.2)
  std::uint32_t serial_baud; ///< tinyos.md 1.1
  std::size_t receive_slots; ///< frames it can hold while the MCU is busy
  duration service_time;     ///< how long the MCU needs per frame, received or sent [estimate]
};

/// MicaZ, IRIS and TelosB.
[[nodiscard]] const std::array<platform, 3>& platforms();

/// @returns nullptr if there is no such platform
[[nodiscard]] const platform* find_platform(std::string_view name);

} // namespace rubicon::radio
