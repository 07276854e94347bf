// What the network layer of a peer counts.
#pragma once

#include <cstdint>

#include "core/describe/fields.hpp"

namespace rubicon::peis {

struct p2p_counters {
  std::uint64_t links_opened = 0;
  std::uint64_t links_refused = 0; ///< by us: handshake failed
  std::uint64_t links_broken = 0;  ///< by us: stream broken, silent, led to nobody
  std::uint64_t octets_received = 0;
  std::uint64_t octets_sent = 0;
  std::uint64_t packages_received = 0;
  std::uint64_t packages_sent = 0; ///< all, forwarded ones and repeats included
  std::uint64_t packages_forwarded = 0;
  std::uint64_t intercepted = 0; ///< not passed on, a hook has consumed them
  std::uint64_t retransmissions = 0;
  std::uint64_t acks_sent = 0; ///< ids, not packages
  std::uint64_t ack_packages_sent = 0;
  std::uint64_t acks_received = 0;
  std::uint64_t messages_delivered = 0;  ///< reliable ones, acknowledged in full
  std::uint64_t messages_failed = 0;     ///< reliable ones, after they had been accepted
  std::uint64_t messages_begun_anew = 0; ///< long ones, whose receiver may have dropped a part
  std::uint64_t routing_sendings = 0;
  std::uint64_t attempts = 0;        ///< to get a link
  std::uint64_t attempts_failed = 0; ///< nobody answered, or refused
  std::uint64_t announcements_sent = 0;
  std::uint64_t announcements_received = 0; ///< of other peers of our network
  std::uint64_t announcements_foreign = 0;  ///< of these, with no address in the listed networks
  std::uint64_t heartbeats_sent = 0;
  std::uint64_t ways_disproved = 0; ///< led in circles (peis-wire.md 9.4)
  // Dropped on receipt.
  std::uint64_t illegal = 0;   ///< port 50 and above, bad type, source or fragment numbers
  std::uint64_t malformed = 0; ///< our own services could not decode it
  std::uint64_t seen = 0;      ///< loops and duplicates
  std::uint64_t repeated = 0;  ///< retransmission of what had arrived
  std::uint64_t own = 0;       ///< came back to us
  std::uint64_t hops = 0;      ///< not passed on, 14 hops made
  std::uint64_t no_route = 0;  ///< not passed on, destination unknown
  std::uint64_t fragments_refused = 0;
  std::uint64_t messages_incomplete = 0; ///< fragments stopped coming
  std::uint64_t duplicate_id = 0;        ///< signs that somebody else uses our id (RTE-08)
  std::uint64_t ids_yielded = 0;         ///< times that we left our id to another peer
  std::uint64_t rivals_refused = 0;      ///< claimed the id of a neighbour that is alive
  std::uint64_t claims_refused = 0;      ///< said in the name of such a neighbour by others
  // Limits of what neighbours may have us do or keep (docs/security.md).
  std::uint64_t work = 0;               ///< charged beyond one unit a package
  std::uint64_t held = 0;               ///< times that a link was not read until its turn came
  std::uint64_t rests = 0;              ///< times that a neighbour was over its budget
  std::uint64_t hosts_refused = 0;      ///< records, the table being full
  std::uint64_t routes_refused = 0;     ///< ways to hosts beyond the table
  std::uint64_t tables_put_off = 0;     ///< routing tables that came too fast; the newest counts
  std::uint64_t questions_refused = 0;  ///< about hosts, too many answers being in flight
  std::uint64_t greetings_evicted = 0;  ///< links closed for others, their request being late
  std::uint64_t newcomers_referred = 0; ///< told whom else to ask, all links being in use
  // Dropped on sending.
  std::uint64_t queue_full = 0;
  std::uint64_t early_drop = 0;
  std::uint64_t queued_lost = 0; ///< unreliable, was queued when its link closed
};
RUBICON_FIELDS(p2p_counters, links_opened, links_refused, links_broken, octets_received,
               octets_sent, packages_received, packages_sent, packages_forwarded, intercepted,
               retransmissions, acks_sent, ack_packages_sent, acks_received, messages_delivered,
               messages_failed, messages_begun_anew, routing_sendings, attempts, attempts_failed,
               announcements_sent, announcements_received, announcements_foreign, heartbeats_sent,
               ways_disproved, illegal, malformed, seen, repeated, own, hops, no_route,
               fragments_refused, messages_incomplete, duplicate_id, ids_yielded, rivals_refused,
               claims_refused, work, held, rests, hosts_refused, routes_refused, tables_put_off,
               questions_refused, greetings_evicted, newcomers_referred, queue_full, early_drop,
               queued_lost);

} // namespace rubicon::peis
