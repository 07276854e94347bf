// What the Network modules of an island say to each other through the tree: the first octet of
// everything that goes up, down or to all says what follows.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <variant>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "network/places/coordinates.hpp"

namespace rubicon::network {

/// 0: for the user of Network.
struct user_content {
  bytes content;

  friend bool operator==(const user_content&, const user_content&) = default;
};

/// 1, up: where its origin is. The packet's header says its parent.
struct place_report {
  std::optional<virtual_coordinates> place;

  friend bool operator==(const place_report&, const place_report&) = default;
};

/// 2, up: where is this mote?
struct place_question {
  mote_id mote;

  friend bool operator==(const place_question&, const place_question&) = default;
};

/// 3, down: there, if the sink knows.
struct place_answer {
  mote_id mote;
  std::optional<virtual_coordinates> place;

  friend bool operator==(const place_answer&, const place_answer&) = default;
};

/// 4, up: a mote is without a route that it may use before the sink counts its sequence number up
/// (RFC 8966 2.4, 3.8.2).
struct sequence_request {
  friend bool operator==(const sequence_request&, const sequence_request&) = default;
};

/// 5, up: a mote needs a round of the clock so often, whose crystal wanders; 0 is read as 1.
struct period_request {
  std::chrono::duration<std::uint16_t> period{};

  friend bool operator==(const period_request&, const period_request&) = default;
};

using router_message = std::variant<user_content, place_report, place_question, place_answer,
                                    sequence_request, period_request>;

[[nodiscard]] bytes encode(const router_message& x);

/// Errors: truncated, too_long (octets after the message), unsupported (unknown kind).
[[nodiscard]] result<router_message> decode_router_message(byte_view octets);

} // namespace rubicon::network
