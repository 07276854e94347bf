// One link to a neighbour, as the network layer keeps it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/link/link.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/link/outgoing_queue.hpp"
#include "peis/wire/heartbeat.hpp"
#include "peis/wire/routing_page.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// What comes over a link (link_input).
struct connection_input {
  stream_decoder decoder;
  bool waits = false;      ///< for its turn, or its neighbour's budget
  bool held = false;       ///< the owner was asked not to read it
  std::int64_t credit = 0; ///< work that it may still have done this turn
  neighbour_budget budget;
  std::uint64_t octets = 0;
  instant last_package;                 ///< a whole one
  instant last_octets;                  ///< handled or not
  std::optional<std::uint32_t> counter; ///< of the neighbour's last package
  double loss = 0;
};

/// What leaves over it (link_writer).
struct connection_output {
  outgoing_queue queue;
  bytes preamble; ///< goes out before any package
  std::uint32_t counter = 0;
  std::uint64_t octets = 0;   ///< handed out
  std::size_t unreported = 0; ///< of these, not yet reported as sent
  /// Reliable packages of ours among them: where they end in octets, and ack ids.
  std::deque<std::pair<std::uint64_t, std::int32_t>> leaving;
  instant drained; ///< when octets were last reported as sent, or began to wait
  instant last_written;
  bool paced = false; ///< the owner was asked to pace it
};

/// A neighbour's routing pages of one sending, until all are there.
struct page_collection {
  std::int32_t seqno = 0;
  std::vector<std::optional<routing_page>> pages;
};

/// Which hosts its neighbour knows (routing_exchange, overlay).
struct connection_routes {
  page_collection pages;
  std::optional<std::vector<routing_entry>> table; ///< whole, but came too soon
  rate_limit table_rate;
  std::deque<peer_id> sources; ///< without a route, oldest first
  bool drained = false;        ///< by the neighbour: it is about to close the link
};

/// Signs of life (heartbeats, link_health).
struct connection_signs {
  std::optional<heartbeat> beat; ///< the neighbour's last
  instant beat_received;
  instant beat_sent;
  std::optional<duration> one_way; ///< half a round trip, little disturbed by waiting
  instant asked;                   ///< when a sign of life was last asked for
  instant next_beside;             ///< try of another link to the same neighbour
};

///   accepting --valid request--> open     (an initiator's link is open from the start)
struct connection {
  link_id id;
  bool open = false;
  instant opened;
  std::uint32_t request_flags = 0;
  std::optional<peer_id> neighbour;
  std::optional<std::int32_t> magic; ///< the neighbour's, by its own word over this link
  std::uint8_t cost = 0;
  std::optional<instant> asked_at;  ///< by the neighbour
  bool named = false;               ///< the neighbour has sent its record
  bool rivals = false;              ///< it has our id, or knows another that has
  std::optional<peer_id> tried_for; ///< whom we have looked for with it
  bool tried_here = false;          ///< at a loopback address
  instant no_room_until;            ///< for further hosts that it brings
  connection_input in;
  connection_output out;
  connection_routes routes;
  connection_signs signs;

  /// Kept up by one of its ends (AUT-01).
  [[nodiscard]] bool always() const {
    return (request_flags & connect_request::all_broadcasts) != 0;
  }
};

} // namespace rubicon::peis
