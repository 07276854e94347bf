// The air and the radios in it.
#pragma once

#include <cstdint>
#include <optional>

#include "actors/messages/common.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "radio/channel/output.hpp"

namespace rubicon {

/// A frame that this radio has received.
struct frame_received {
  payload psdu; ///< IEEE 802.15.4, FCS included; one object for all receivers
  std::int8_t rssi_dbm = 0;
};
RUBICON_FIELDS(frame_received, psdu, rssi_dbm);

/// A request to send has come to its end.
struct radio_done {
  std::uint64_t token = 0;
  radio::send_status status = radio::send_status::sent;
  unsigned transmissions = 0;
  bool arrived = false; ///< its destination has it; only a simulated air knows
  radio::copy_outcome last =
      radio::copy_outcome::out_of_reach; ///< of the last copy at its destination
};
RUBICON_FIELDS(radio_done, token, status, transmissions, arrived, last);

/// The battery that feeds this radio is flat; the radio is off.
struct battery_flat {};
RUBICON_FIELDS(battery_flat);

/// It soon will be: radio::battery_reserve of its charge is left.
struct battery_low {};
RUBICON_FIELDS(battery_low);

/// Whoever owns a radio: a mote or a sink.
struct radio_user_interface : takes<frame_received, radio_done, battery_low, battery_flat> {};
using radio_user_actor = ref<radio_user_interface>;

/// From now on this radio's frames are for `user`; switches the radio on.
struct attach_radio {
  radio::radio_index radio;
  radio_user_actor user;
};
RUBICON_FIELDS(attach_radio, radio, user);

inline constexpr std::uint8_t no_age = 0xff;

struct radio_send {
  radio::radio_index radio;
  std::uint64_t token = 0;
  mote_id destination;
  std::uint8_t am_type = 0;
  payload octets;
  bool ack = true;
  std::uint8_t age_at = no_age; ///< as in radio::request; the next too
  bool in_slot = false;
};
RUBICON_FIELDS(radio_send, radio, token, destination, am_type, octets, ack, age_at, in_slot);

/// A frame of whatever layout, without its FCS: radio::request::is_raw.
struct radio_send_raw {
  radio::radio_index radio;
  std::uint64_t token = 0;
  payload octets;
};
RUBICON_FIELDS(radio_send_raw, radio, token, octets);

struct radio_power {
  radio::radio_index radio;
  radio::power state = radio::power::off;
};
RUBICON_FIELDS(radio_power, radio, state);

/// The processor of this radio's mote computes for so long.
struct computation {
  radio::radio_index radio;
  duration length{};
};
RUBICON_FIELDS(computation, radio, length);

/// The radio is somewhere else from now on.
struct move_radio {
  radio::radio_index radio;
  position place;
};
RUBICON_FIELDS(move_radio, radio, place);

/// From the fault plan: this transmitter, which is no mote's, sends bursts of noise for so long.
struct make_noise {
  radio::radio_index from;
  double duty = 1; ///< share of the time, 0..1
  duration burst{};
  duration length{};
};
RUBICON_FIELDS(make_noise, from, duty, burst, length);

/// From the fault plan: copies for radios of an island are lost by this chance besides, for so
/// long.
struct lose_frames {
  bool everywhere = true;
  island_id island; ///< if not everywhere
  double loss = 0;  ///< 0..1
  duration length{};
};
RUBICON_FIELDS(lose_frames, everywhere, island, loss, length);

/// From the fault plan: the mote of this radio is carried away. radio_left follows.
struct carry_away {
  radio::radio_index radio;
};
RUBICON_FIELDS(carry_away, radio);

/// From the fault plan: a mote whose radio this is has come, with a battery of which so much is
/// used.
struct bring_radio {
  radio::radio_index radio;
  double used_mah = 0;
};
RUBICON_FIELDS(bring_radio, radio, used_mah);

/// From the plan: a link is another from now on. What is not set stays as it is.
struct change_link {
  mote_address from;
  mote_address to;
  std::optional<double> loss; ///< 0..1
  std::optional<double> gain_db;
};
RUBICON_FIELDS(change_link, from, to, loss, gain_db);

/// The radio medium of one place.
struct air_interface
    : takes<attach_radio, radio_send, radio_power, computation, move_radio, make_noise, lose_frames,
            carry_away, bring_radio, change_link, timer_expired, status_request, radio_send_raw> {};
using air_actor = ref<air_interface>;

} // namespace rubicon
