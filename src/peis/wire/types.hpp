// The words that every part of a PEIS kernel shares: ids, priorities, why something failed.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::peis {

struct link_tag;
struct attempt_tag;
struct request_tag;
struct subscription_tag;

/// One link to a neighbour, named by the owner of the kernel; never used twice by the same owner.
using link_id = strong_id<link_tag, std::uint64_t>;

/// One attempt of the kernel to get a link, named by the kernel.
using attempt_id = strong_id<attempt_tag, std::uint64_t>;

/// Named by the caller of a command, returned with its outcome. Zero asks for no outcome.
using request_id = strong_id<request_tag, std::uint64_t>;

/// Named by the caller of subscription_commands::subscribe(), returned with each of its tuples.
using subscription_id = strong_id<subscription_tag, std::uint64_t>;

inline constexpr request_id no_request{0};

/// Request and subscription ids from here on are the kernel's own; callers use smaller ones.
inline constexpr std::uint64_t own_ids_first = std::uint64_t{1} << 63U;

/// Who opened the link: the initiator speaks first (docs/peis-wire.md 3.2).
enum class link_role : std::uint8_t { initiator, acceptor };

/// What a user may ask for; link control and acknowledgements go before all of these.
/// Messages of more than one package always travel as bulk.
enum class priority : std::uint8_t { high, normal, bulk };

/// How a request ended (ACK-05, TUP-24).
enum class cause : std::uint8_t {
  none,             ///< it succeeded
  no_route,         ///< no route to the destination is known
  too_many_retries, ///< transmitted seven times, never acknowledged (ACK-03)
  queue_full,
  early_drop,      ///< given up at random because the queue was more than half full (P2P-03)
  connection_dead, ///< the last route was lost and did not return before the retries ended
  host_gone,       ///< the destination has left, was restarted or has been lost for too long
  too_long,        ///< message or value above 16 MiB, broadcast above 1024 octets (API-08)
  bad_port,        ///< not one of the ports 20..49 (API-09)
  bad_key,         ///< TUP-03
  bad_value,       ///< MIME type longer than 254 octets, or a time that the wire cannot carry
  abstract,        ///< a wildcard where one tuple must be named in full (TUP-06)
  space_full,      ///< no room for another tuple or subscription
  bad_handle,      ///< subscription id that is in use already, or unknown
  bad_index,       ///< the cursor of a result set stands on no tuple
  bad_meta_tuple,  ///< not a meta tuple, or one that points nowhere and is to be written through
  refused,         ///< the owner does not let others write that tuple, or has no room (TUP-22)
  left,            ///< this kernel has left the network
};

[[nodiscard]] std::string_view to_string(cause x);

/// Why a link must be closed.
enum class close_cause : std::uint8_t {
  bad_stream,     ///< wrong sync word, length or id: the rest of the stream means nothing (TCP-06)
  wrong_version,  ///< protocol version is not 500
  wrong_network,  ///< network strings differ (LNK-06)
  own_id,         ///< the other side claims our own id
  bad_id,         ///< the other side claims an id that no peer may have
  too_many_links, ///< all 64 slots are taken
  handshake_silent, ///< no connect request in time
  silent,           ///< nothing arrived for 30 s (docs/peis-wire.md 3.5)
  host_left,        ///< the neighbour has left the network or was given up
  double_link,      ///< a second link to the same neighbour (CM-11)
  replaced,         ///< nothing comes or leaves over it, unlike over a newer one
  unneeded,         ///< the one of least value among too many (CM-08)
  leaf,             ///< we are a leaf and the other side is on another host (LEA-01)
  reborn,           ///< leads to an earlier incarnation of a restarted peer (docs/peis-wire.md 10)
  over_budget,      ///< kept sending though nothing was taken any more
  nameless,         ///< asked for a link, but never introduced itself
};

[[nodiscard]] std::string_view to_string(close_cause x);

} // namespace rubicon::peis
