// What the Network module of an island carries for those above it: component management between a
// mote and its sink, and packets with the header of D1.1 5.4 in as many fragments as they need
// (NET-14).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "network/island_packet.hpp"
#include "network/router.hpp"
#include "transport/fragments.hpp"

namespace rubicon::mote {

/// A whole packet has arrived.
struct packet_in {
  std::optional<mote_id> origin; ///< a mote of the island; nothing: the sink has sent it down
  bool to_all = false;
  network::island_packet packet;
};

/// A component management message has arrived.
struct management_in {
  mote_id origin;
  bytes octets;
};

using packet_service_output =
    std::variant<network::frame_out, packet_in, management_in, network::clock_corrected,
                 network::channel_connected, network::channel_accepted, network::channel_received,
                 network::channel_ended, network::channel_reserved>;
using packet_service_outputs = std::vector<packet_service_output>;

struct packet_service_counters {
  std::uint64_t unroutable = 0; ///< packets for motes to which no route is known
  std::uint64_t malformed = 0;
};
RUBICON_FIELDS(packet_service_counters, unroutable, malformed);

class packet_service {
public:
  packet_service() = default;
  packet_service(network::router_config config, random_stream rng, instant now);

  /// To a mote of the island. A mote that is no neighbour is reached through the sink, which gets
  /// the packet and must send it on.
  /// @param in_slot as in network::channels::send()
  /// @pre x.body.size() <= network::body_max
  [[nodiscard]] packet_service_outputs send(mote_id to, const network::island_packet& x,
                                            instant now, bool in_slot = false);
  [[nodiscard]] packet_service_outputs send_to_all(const network::island_packet& x, instant now);
  [[nodiscard]] packet_service_outputs send_management(mote_id to, byte_view message, instant now);

  // The rest of the Network module; outputs of router() itself go through carry().
  [[nodiscard]] packet_service_outputs on_frame(mote_id source, std::uint8_t am_type,
                                                byte_view payload, instant sfd, instant now,
                                                network::medium over = network::medium::radio);
  [[nodiscard]] packet_service_outputs on_sent(std::uint64_t token, bool acked,
                                               unsigned transmissions, instant now);
  [[nodiscard]] packet_service_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] instant deadline() const { return router_.deadline(); }

  [[nodiscard]] network::router& router() { return router_; }
  [[nodiscard]] const network::router& router() const { return router_; }
  [[nodiscard]] packet_service_outputs carry(network::router_outputs from_router, instant now);

  [[nodiscard]] const packet_service_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t footprint() const {
    return router_.footprint() + fragments_.footprint(network::packet_max) + 1;
  }

private:
  void take(network::content_in x, packet_service_outputs& out, instant now);

  network::router router_;
  transport::assembly fragments_;
  std::uint8_t tag_ = 0;
  packet_service_counters counters_;
};

} // namespace rubicon::mote
