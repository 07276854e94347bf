// What a gateway asks of its owner.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "network/sink_event.hpp"

namespace rubicon::gateway {

/// Set this own tuple. Text goes without a trailing NUL here; the tuple layer adds it.
struct publish {
  std::string key;
  bytes value;
  bool text = false;
};

/// Delete this own tuple.
struct erase {
  std::string key;
};

/// Send this packet down the serial line.
struct to_sink {
  mote_id mote; ///< whom it is for in the end
  std::uint8_t am_type = 0;
  bytes payload; ///< at most network::frame_payload_max octets
  provenance from = {};
};

/// Answer its question at once: it is of no use when it is late.
struct answer_sink {
  network::sink_event answer; ///< `held` of a time_answer is for who knows the line
};

/// What has been written to an input of a mote with a plain program; on_plain_done() says how it
/// has ended.
struct to_plain {
  std::uint64_t number = 0;
  mote_id mote;
  std::uint16_t channel = 0;
  bytes octets;
  provenance from = {};
};

/// Send this to another gateway of the island, PEIS port 22, reliably.
struct relay_to {
  peer_id peer;
  bytes octets;
};

/// This gateway leads its island, or no longer does (GW-14).
struct lead_changed {
  bool leads = false;
  std::uint32_t term = 0;
};

/// Send this message (WIR-02) to another gateway, PEIS port 21.
struct to_gateway {
  peer_id peer;
  bytes octets;
  bool reliable = false; ///< as the sending mote asked (ACK-09)
  provenance from = {};
};

/// Broadcast this on announcement_port.
struct announce {
  bytes octets;
};

/// A mote is listed, listed again after a restart, or no longer listed.
struct member_changed {
  mote_id mote;
  bool listed = false;
  std::uint32_t incarnation = 0;
  network::leave_cause cause = network::leave_cause::notice; ///< when no longer listed
};

/// Nothing has come from the sink for a while, or something again (GW-15).
struct line_changed {
  bool up = false;
  duration silence{}; ///< for how long nothing came, when it is up again
};

using output = std::variant<publish, erase, to_sink, answer_sink, to_plain, to_gateway, relay_to,
                            announce, member_changed, line_changed, lead_changed>;
using outputs = std::vector<output>;

} // namespace rubicon::gateway
