// One mote's radio above the medium.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/address.hpp"
#include "core/time.hpp"
#include "radio/channel/battery_watch.hpp"
#include "radio/channel/output.hpp"
#include "radio/listener.hpp"
#include "radio/mac.hpp"
#include "radio/medium/receiver.hpp"
#include "radio/parameters.hpp"
#include "radio/radio_counters.hpp"

namespace rubicon::radio {

/// Of a radio that listens at low power.
struct low_power_listening {
  listening_config config;
  std::optional<listener> ears;  ///< nothing: its mote is off
  std::uint64_t event_stamp = 0; ///< of the event in the queue
};

struct station {
  mote_id address;
  std::uint16_t pan = default_pan;
  duration service_time{};
  power supply = power::on;
  std::uint8_t next_dsn = 0;
  mac sender;
  receiver inbox;
  radio_counters
      counted;          ///< copies: of links that are no more; requests.open: filled in when asked
  link_counters copies; ///< that it has sent
  battery_watch battery;
  instant guarded_until;            ///< mac_rules::guard
  std::optional<instant> scheduled; ///< the deadline of `sender` that stands in the event queue
  std::uint64_t mac_stamp = 0;
  std::optional<std::uint8_t> ack_dsn; ///< of the ack it is about to send
  std::uint64_t ack_stamp = 0;
  std::unique_ptr<low_power_listening> listens; ///< nullptr: its radio is on as long as its mote is
};

} // namespace rubicon::radio
