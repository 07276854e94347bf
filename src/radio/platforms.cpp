#include "radio/parameters.hpp"

#include <algorithm>

namespace rubicon::radio {

const std::array<platform, 3>& platforms() {
  // Currents: tinyos.md 8.1, of the chips at 3 V and full power. Sleep is "sleep, timer on"; off is
  // "radio off / sleep". Battery: tinyos.md 8.2. Baud: tinyos.md 1.1.
  //
  // Receive slots: an RF230 stack holds 3 messages (tinyos.md 10). A CC2420's FIFO has 128 octets:
  // three frames of the default maximum payload with their length octets, 3 x 42 (tinyos.md 4.1).
  //
  // Service times are estimates: reading 20..40 octets over SPI in a split-phase driver, checking
  // the header and running a task, on an 8 MHz AVR (the RF230's buffer is read in one burst) and a
  // 4 MHz MSP430.
  static constexpr std::array<platform, 3> table{{
      {
          .name = "micaz",
          .mcu_active_ma = 8.0,
          .mcu_sleep_ma = 0.015,
          .radio_off_ma = 0.001,
          .radio_listen_ma = 18.8,
          .radio_transmit_ma = 17.4,
          .supply_v = 3.0,
          .battery_mah = 2000,
          .serial_baud = 57600,
          .receive_slots = 3,
          .service_time = 2ms,
      },
      {
          .name = "iris",
          .mcu_active_ma = 8.0,
          .mcu_sleep_ma = 0.008,
          .radio_off_ma = 0.00002,
          .radio_listen_ma = 15.5,
          .radio_transmit_ma = 16.5,
          .supply_v = 3.0,
          .battery_mah = 2000,
          .serial_baud = 57600,
          .receive_slots = 3,
          .service_time = 1500us,
      },
      {
          .name = "telosb",
          .mcu_active_ma = 1.8,
          .mcu_sleep_ma = 0.0051,
          .radio_off_ma = 0.001,
          .radio_listen_ma = 18.8,
          .radio_transmit_ma = 17.4,
          .supply_v = 3.0,
          .battery_mah = 2000,
          .serial_baud = 115200,
          .receive_slots = 3,
          .service_time = 2500us,
      },
  }};
  return table;
}

const platform* find_platform(std::string_view name) {
  const auto& all = platforms();
  const auto found =
      std::find_if(all.begin(), all.end(), [name](const platform& x) { return x.name == name; });
  return found == all.end() ? nullptr : &*found;
}

} // namespace rubicon::radio
