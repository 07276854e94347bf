// What a channel is given: its radios, and frames to be sent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "radio/mac_rules.hpp"
#include "radio/parameters.hpp"

namespace rubicon::radio {

/// A radio that joins the channel. It is on from the start.
struct radio_config {
  mote_id address;                 ///< unique in its PAN
  std::uint16_t pan = default_pan; ///< one per island; frames of other PANs only disturb
  position place;
  const platform* kind = nullptr; ///< never nullptr; one of platforms(), or outlives the channel
  std::optional<double> transmit_dbm; ///< unset: the platform's full power
  std::optional<double> battery_mah;  ///< > 0; unset: the platform's; infinity: fed by a cable
  bool promiscuous = false;     ///< delivers all data frames received, of any PAN and for any mote
  access_parameters access{};   ///< macMinBE is not above macMaxBE
  listening_config listening{}; ///< the same for all radios of a PAN, but for its `checks`
  /// Radios of other channels neither receive it nor are disturbed; all_channels: of a source of
  /// noise.
  std::uint8_t channel = default_channel;
};

/// A request to send one frame.
struct request {
  std::uint64_t token = 0; ///< comes back in `done`; the channel attaches no meaning
  mote_id destination = broadcast_mote;
  std::uint8_t am_type = 0;
  rubicon::payload payload; ///< at most payload_max octets
  bool ack = true;          ///< unicast only: wait for an ack and repeat without one
  /// Where in the payload a uint32 in network byte order lies, to which each transmission adds the
  /// microseconds from this request to its start-of-frame delimiter (CLK-01; chips with a frame
  /// buffer can do it while they send). @pre four octets of payload follow
  std::optional<std::size_t> age_at = {};
  /// No radio near is to send now, but one is right afterwards: the channel is assessed without
  /// a back-off, and neither a busy channel nor a missing ack leads to another attempt. Where
  /// radios listen at low power it means nothing.
  bool in_slot = false;
  /// `payload` is a whole frame of whatever layout, without its FCS (radio/raw_frame.hpp), and
  /// nothing of the above but the token means anything. @pre it is no ack, and has 3 octets or more
  bool is_raw = false;
};

} // namespace rubicon::radio
