// What the peer-to-peer layer reports to the kernel above it, and requests of the links below.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/bytes.hpp"
#include "peis/bluetooth/bluetooth.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Octets for the other end of a link, in order; several packages may be in one.
struct to_link {
  link_id link;
  payload octets;
};

/// The link is of no use any more: close it when what to_link gave it has been sent. The kernel has
/// forgotten it already, and on_link_closed() for it is harmless.
struct close_link {
  link_id link;
  close_cause why;
};

/// Whether more octets of a link are wanted now. While they are not, what it has brought waits for
/// its turn or its neighbour is over its budget: a medium that can stops reading, so that the rest
/// waits at the other end. What comes nevertheless is kept, up to p2p_config::input_max.
struct read_link {
  link_id link;
  bool wanted = true;
};

/// The other side takes packages as a whole only, and waits with its window closed if it has got
/// the first part of one. From now on each to_link of this link is a package: a medium that can
/// begins to send one only if there is room for all of it at the other side, and what it reports
/// with on_link_sent() is what the other side's machine has acknowledged.
struct pace_link {
  link_id link;
};

/// A link to this address is wanted: try it, then call on_link_open() or on_attempt_failed() with
/// the attempt's name. The kernel itself gives up after its connect_timeout, and then ignores both.
struct connect_to {
  attempt_id attempt;
  std::string url; ///< `tcp://host:port`, `inproc://id`, `udp://host:port`, `bt://address;port`
};

/// One datagram for the group that all peers listen to (peis-wire.md 4), or for what stands for it.
struct announce {
  payload octets;
};

/// A peer can be reached and described, or cannot any more. After a restart vanished, then
/// appeared.
struct host_appeared {
  peer_id host;
  std::int32_t incarnation = 0; ///< its magic number
};
struct host_vanished {
  peer_id host;
};

/// A whole message for us on a port above the network's own.
struct arrived {
  std::uint16_t port = 0;
  peer_id source;
  bool broadcast = false;
  link_id from; ///< over which it, or its last part, came: who is charged for what it costs
  bytes octets;
  provenance origin = {};
};

/// A message that asked for an outcome has been acknowledged in full (or sent, if unreliable).
struct delivered {
  request_id request;
};

/// A message could not be delivered. `head` and `port` say which, for messages without request.
struct undelivered {
  request_id request;
  peer_id destination;
  std::uint16_t port = 0;
  payload head;
  cause why = cause::none;
};

/// The peers that a package has passed to a host and back, ourselves first; empty if nothing came
/// back in time.
struct traced {
  request_id request;
  peer_id destination;
  std::vector<peer_id> route;
};

/// Another live peer uses our id (RTE-08). Reported once for each incarnation of it, and whenever
/// we leave the id to it.
struct id_taken {
  std::string by;        ///< its full name, program@host!process
  duration stays_away{}; ///< we keep off the network so long, then try again; zero: we stay
};

/// A HELLO connection is wanted, to hello_port of a device seen by an adapter of ours. It carries
/// who we are and brings who is there: on_hello_answer(), for each peer that answers.
struct say_hello {
  std::string adapter;
  bluetooth_address to;
  payload octets;
};

/// Another computer has our host name, as two fresh installations have. From here on its peers are
/// reached at its network addresses. Reported once for each of them.
struct namesake_found {
  peer_id host;
  std::string full_name; ///< program@host!process
};

/// A hook has consumed a package that was on its way through here (API-06).
struct intercepted {
  std::uint16_t port = 0;
  peer_id source;
  peer_id destination; ///< any_peer: it was a broadcast, which goes no further from here
};

/// That host says it has forgotten us, subscriptions included (peis-wire.md 11, reason 2).
struct forgotten_by {
  peer_id host;
};

using event =
    std::variant<to_link, close_link, read_link, pace_link, connect_to, announce, host_appeared,
                 host_vanished, arrived, delivered, undelivered, forgotten_by, traced, id_taken,
                 namesake_found, intercepted, scan_adapter, say_hello, device_noted>;
using events = std::vector<event>;

} // namespace rubicon::peis
