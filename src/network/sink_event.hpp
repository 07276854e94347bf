// What a sink and its gateway exchange about the island (DIS-03, GW-15) and about the time
// (CLK-08): the payload of serial packets of type am::sink_event, in network byte order, one octet
// of kind first.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::network {

/// Why a mote is no longer in its island.
enum class leave_cause : std::uint8_t {
  notice = 1,       ///< it has said goodbye
  silence = 2,      ///< nothing was received for its keep-alive window
  battery = 3,      ///< the same, after it had reported that its battery was nearly flat
  out_of_range = 4, ///< the same, after its only links had become weak
};

[[nodiscard]] std::string to_string(leave_cause x);

/// Up: a mote has completed its join, or was asked for by `describe`.
struct mote_joined {
  mote_id mote;
  std::uint32_t incarnation = 0; ///< counts the mote's starts
  std::uint32_t type = 0;        ///< its signature (PXY-13)
  bytes descriptor;              ///< as the mote sent it, for proxies to read

  friend bool operator==(const mote_joined&, const mote_joined&) = default;
};

/// Up: a mote has left.
struct mote_left {
  mote_id mote;
  leave_cause cause = leave_cause::notice;

  friend bool operator==(const mote_left&, const mote_left&) = default;
};

struct roster_entry {
  mote_id mote;
  std::uint32_t incarnation = 0;

  friend bool operator==(const roster_entry&, const roster_entry&) = default;
};

/// Up, now and then: one page of all members, so that a lost event is noticed.
struct roster {
  std::uint16_t number = 0; ///< the same on all pages of one roster
  std::uint8_t page = 0;
  std::uint8_t pages = 1;
  std::vector<roster_entry> entries; ///< ascending by mote over all pages

  friend bool operator==(const roster&, const roster&) = default;
};

/// Down: say `mote_joined` again for this mote; with broadcast_mote: begin a new roster at once.
struct describe {
  mote_id mote;

  friend bool operator==(const describe&, const describe&) = default;
};

/// Up: the sink has been started, and knows no mote yet.
struct sink_started {
  friend bool operator==(const sink_started&, const sink_started&) = default;
};

/// Up: what is the time? As long as its answer: then both take the line equally long, and the
/// answer was true in the middle between the moments at which they began to leave, at any baud
/// rate.
struct time_request {
  std::uint16_t number = 0; ///< of this question

  friend bool operator==(const time_request&, const time_request&) = default;
};

/// Down: the time that the peers share, when the request came.
struct time_answer {
  std::uint16_t number = 0;               ///< the request's
  std::chrono::microseconds since_1970{}; ///< from 0, before network_time_end
  std::chrono::microseconds held{};       ///< from then until the line was free; 0 to 2^32 - 1

  friend bool operator==(const time_answer&, const time_answer&) = default;
};

/// Up, to each of several gateways, now and then: are you there? And who leads (GW-14)?
struct gateway_poll {
  std::uint32_t life = 0; ///< of the gateway, as the sink knows it; unknown_life: not yet
  std::uint32_t term = 0; ///< of the gateway that leads; each handing over begins the next one
  bool leads = false;     ///< it is this one, if `life` is right

  friend bool operator==(const gateway_poll&, const gateway_poll&) = default;
};

inline constexpr std::uint32_t unknown_life = 0xffffffff;

/// Down, at once: here I am.
struct gateway_answer {
  std::uint32_t life = 0; ///< counts the gateway's starts
  std::uint32_t term = 0; ///< the latest that it has received

  friend bool operator==(const gateway_answer&, const gateway_answer&) = default;
};

using sink_event = std::variant<mote_joined, mote_left, roster, describe, sink_started,
                                time_request, time_answer, gateway_poll, gateway_answer>;

inline constexpr std::size_t roster_entries_max = 18; ///< a page fits 114 octets

/// @pre a roster has at most roster_entries_max entries
[[nodiscard]] bytes encode(const sink_event& x);

/// Errors: truncated, too_long (octets after the event), bad_value (also what fills a request up
/// is not zero, or a flag neither 0 nor 1), unsupported (unknown kind).
[[nodiscard]] result<sink_event> decode_sink_event(byte_view octets);

} // namespace rubicon::network
