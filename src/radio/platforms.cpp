#include "radio/parameters.hpp"

#include <algorithm>

namespace rubicon::radio {

const std::array<platform, 3>& platforms() {
  // Currents of the chips at 3 V, batteries, sensitivity: docs/tinyos.md 7. Sleep is "asleep with
  // its timer". Baud: docs/tinyos.md 1.1. Energy thresholds: CC2420, docs/tinyos.md 5.1; the
  // AT86RF230's data sheet has the same -77 dBm as default.
  //
  // Receive slots: an RF230 stack holds 3 messages (docs/tinyos.md 7.3). A CC2420's FIFO has 128
  // octets: three frames of the default maximum payload with their length octets, 3 x 42.
  //
  // Service times are estimates: reading 20..40 octets over SPI in a split-phase driver, checking
  // the header and running a task, on an 8 MHz AVR (the RF230's buffer is read in one burst) and a
  // 4 MHz MSP430.
  static constexpr std::array<transmit_level, 8> cc2420_levels{{{-25, 8.5},
                                                                {-15, 9.9},
                                                                {-10, 11.2},
                                                                {-7, 12.5},
                                                                {-5, 13.9},
                                                                {-3, 15.2},
                                                                {-1, 16.5},
                                                                {0, 17.4}}};
  static constexpr std::array<platform, 3> table{{
      {
          .name = "micaz",
          .mcu_active_ma = 8.0,
          .mcu_sleep_ma = 0.015,
          .radio_off_ma = 0.001,
          .radio_listen_ma = 18.8,
          .transmit = cc2420_levels,
          .supply_v = 3.0,
          .battery_mah = 2000,
          .sensitivity_dbm = -95,
          .cca_dbm = -77,
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
          .transmit = {{{-17, 9.5},
                        {-17, 9.5},
                        {-17, 9.5},
                        {-17, 9.5},
                        {-17, 9.5},
                        {-17, 9.5},
                        {-3, 13},
                        {3, 16.5}}},
          .supply_v = 3.0,
          .battery_mah = 2000,
          .sensitivity_dbm = -101,
          .cca_dbm = -77,
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
          .transmit = cc2420_levels,
          .supply_v = 3.0,
          .battery_mah = 2000,
          .sensitivity_dbm = -95,
          .cca_dbm = -77,
          .serial_baud = 115200,
          .receive_slots = 3,
          .service_time = 2500us,
      },
  }};
  return table;
}

double platform::transmit_ma(double dbm) const {
  const auto above = std::find_if(transmit.begin(), transmit.end(),
                                  [dbm](const transmit_level& x) { return x.dbm > dbm; });
  if (above == transmit.end())
    return transmit.back().current_ma;
  if (above == transmit.begin())
    return above->current_ma;
  const auto& below = *(above - 1);
  const auto share = (dbm - below.dbm) / (above->dbm - below.dbm);
  return below.current_ma + share * (above->current_ma - below.current_ma);
}

const platform* find_platform(std::string_view name) {
  const auto& all = platforms();
  const auto found =
      std::find_if(all.begin(), all.end(), [name](const platform& x) { return x.name == name; });
  return found == all.end() ? nullptr : &*found;
}

} // namespace rubicon::radio
