// What a channel says: frames that have arrived, requests that have ended, batteries.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "radio/frame.hpp"
#include "radio/mac.hpp"
#include "radio/medium/topology.hpp"
#include "radio/radio_counters.hpp"

namespace rubicon::radio {

/// What became of a mote's power.
enum class power : std::uint8_t {
  on,
  off,  ///< crashed or being restarted: the radio is off, the MCU draws its sleep current
  flat, ///< the battery is at its end: nothing is drawn any more. Final: there is no route back to
        ///< on
};

[[nodiscard]] std::string to_string(power x);

/// A frame for the mote of radio `to`.
struct delivered {
  radio_index to;
  payload psdu;             ///< one object for all receivers
  frame content;            ///< views `psdu`, valid as long as any copy of it
  std::int8_t rssi_dbm = 0; ///< whole dBm, as the chips report it
  std::uint8_t lqi = 0;     ///< 50..110 (docs/tinyos.md 4.1)
  provenance from = {};     ///< of the request
};

/// A request has come to its end; each gets exactly one.
struct done {
  radio_index radio;
  std::uint64_t token = 0;
  send_status status = send_status::sent;
  unsigned transmissions = 0; ///< times the frame was put on the air; a train of copies is one
  bool arrived = false;       ///< its destination accepted it, whether or not the sender knows
  copy_outcome last =
      copy_outcome::out_of_reach; ///< of the last copy at its destination; unicast only
  provenance from = {};           ///< of the request
};

/// The battery of a mote is flat. The radio has already been switched to power::flat.
struct exhausted {
  radio_index radio;
};

/// No more than battery_reserve is left in a mote's battery.
struct running_low {
  radio_index radio;
};

/// A frame has ended; only while the channel is watched.
struct overheard {
  std::uint16_t pan = 0; ///< of its sender
  instant begin;         ///< of its preamble
  payload psdu;          ///< acks included
  bool received = false; ///< by anybody it was meant for
  copy_outcome outcome =
      copy_outcome::out_of_reach; ///< of the copy at its destination; unicast data only
  provenance from = {};           ///< of the request
};

using output = std::variant<delivered, done, exhausted, running_low, overheard>;
using outputs = std::vector<output>;

} // namespace rubicon::radio
