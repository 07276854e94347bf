// What a tuple space reports to the kernel above it, and requests of the network below.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "peis/link/outgoing_queue.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// A tuple matching a subscription or callback was set or appended to, here or by its owner, also
/// to an equal value (CB-01). Never null; shared with the tuple space and all others.
struct tuple_changed {
  subscription_id subscription;
  tuple_pointer content;
};

/// It was deleted, has expired or its owner is gone. `content` is the last value known.
struct tuple_deleted {
  subscription_id subscription;
  tuple_pointer content;
  provenance from = {};
};

/// To be sent reliably to one peer.
struct transmit {
  peer_id destination;
  std::uint16_t port = 0;
  message_octets content;
  request_id request;
  provenance from = {};
};

/// To be broadcast.
struct transmit_all {
  std::uint16_t port = 0;
  payload octets;
};

using tuple_event = std::variant<tuple_changed, tuple_deleted, transmit, transmit_all>;
using tuple_events = std::vector<tuple_event>;

} // namespace rubicon::peis
