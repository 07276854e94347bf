// Component management on the radio: the payload of frames of type am::component_management
// (DIS-08). One octet of kind, then fields in network byte order.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "network/clock/tick_plan.hpp"

namespace rubicon::mote {

/// Mote to everybody: who takes me in?
struct join_request {
  std::uint16_t sequence = 0;
  std::uint32_t incarnation = 0; ///< counts the mote's starts (DIS-07)
  bytes descriptor;

  friend bool operator==(const join_request&, const join_request&) = default;
};

inline constexpr std::size_t aliases_max = 3; ///< that a mote remembers

/// Sink to mote: you are in, once you confirm.
struct join_reply {
  std::uint16_t sequence = 0; ///< of the request
  island_id island;
  mote_id mote;                   ///< the address the mote is to use
  std::uint32_t time_ms = 0;      ///< the sink's clock
  std::vector<island_id> aliases; ///< of the island (GW-14), 1..254 each, at most aliases_max

  friend bool operator==(const join_reply&, const join_reply&) = default;
};

/// Mote to sink.
struct join_confirm {
  std::uint16_t sequence = 0;
  std::uint32_t incarnation = 0;
  bytes descriptor;

  friend bool operator==(const join_confirm&, const join_confirm&) = default;
};

/// Mote to sink: goodbye.
struct leave_notice {
  friend bool operator==(const leave_notice&, const leave_notice&) = default;
};

/// What may be why a mote falls silent (IF-13).
struct mote_condition {
  bool battery_low = false;
  bool links_weak = false; ///< its parent's frames come with little more power than it can receive

  friend bool operator==(const mote_condition&, const mote_condition&) = default;
};

/// Mote to sink: still here, with nothing else to say; or its condition has changed.
struct keep_alive {
  std::uint32_t incarnation = 0;
  mote_condition condition;
  std::uint32_t device = 0; ///< as in descriptor; 0: unknown

  friend bool operator==(const keep_alive&, const keep_alive&) = default;
};

/// Sink to mote: I do not know you, join again.
struct rejoin_prompt {
  friend bool operator==(const rejoin_prompt&, const rejoin_prompt&) = default;
};

/// Mote to sink: my synaptic vectors take so many units of each tick, and I have this slot for them
/// (SYN-16).
struct slot_notice {
  std::uint16_t units = 0; ///< 0: I send none
  network::slot_run slot;

  friend bool operator==(const slot_notice&, const slot_notice&) = default;
};

/// Sink to mote: this is your slot; no units: there is no room for so many.
struct slot_grant {
  network::slot_run slot;

  friend bool operator==(const slot_grant&, const slot_grant&) = default;
};

/// Sink to mote: another mote has your address, and is a member (ADR-04).
struct join_refusal {
  std::uint16_t sequence = 0; ///< of the request, by which the other knows that it is not meant

  friend bool operator==(const join_refusal&, const join_refusal&) = default;
};

using management = std::variant<join_request, join_reply, join_confirm, leave_notice, keep_alive,
                                rejoin_prompt, slot_notice, join_refusal, slot_grant>;

[[nodiscard]] bytes encode(const management& x);

/// Errors: truncated, too_long, bad_value (a condition not known here), unsupported (unknown kind).
[[nodiscard]] result<management> decode_management(byte_view octets);

} // namespace rubicon::mote
