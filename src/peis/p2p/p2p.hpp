// The peer-to-peer layer: links, greeting, routing, forwarding, hosts, reliable messages
// (peis-wire.md 3 to 11, requirements A7, A8, A10).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/text/ipv4_network.hpp"
#include "core/time.hpp"
#include "peis/bluetooth/bluetooth.hpp"
#include "peis/links/message_delivery.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/network_clock.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/overlay/p2p_config.hpp"
#include "peis/overlay/p2p_counters.hpp"
#include "peis/overlay/p2p_events.hpp"
#include "peis/overlay/transit_hooks.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// What the layer knows.
struct p2p_view {
  const own_peer& own; ///< our record, configuration and counters; whether we have left
  const link_table& links;
  const host_table& hosts;
  const overlay& routes;
  const network_clock& clock;
  const bluetooth& adapters;

  /// Can a message be sent to that peer now? To ourselves always.
  [[nodiscard]] bool reachable(peer_id host) const {
    return host == own.config.id || routes.reachable(host);
  }
  /// Is that host known by its present incarnation?
  [[nodiscard]] bool knows_present(peer_id host) const {
    return host == own.config.id || hosts.knows_present(host);
  }
};

/// Works on links that the owner names and carries octets for. Calls collect events; take_events()
/// and flush() hand them out, so that packages of one occasion leave each link in one piece. Hands
/// each call to the class whose duty it is:
///
///   links      link_table, link_greeting (who may have one), introductions (who is at the other
///              end), link_input (whose turn it is), link_writer, link_health, heartbeats,
///              link_replacer, link_closer
///   packages   package_handler, package_sender, message_delivery, transit_hooks
///   routes     overlay, routing_exchange, routing_updates, route_tracer
///   hosts      host_table, host_inquiry, host_presence, host_removal, incarnations
///   identity   own_id, id_guard
///   whom to connect to
///              matchmaker, dialler, contact_history, announcer
///   time       clock_service
class p2p {
public:
  p2p();
  ~p2p();
  p2p(p2p&&) noexcept;
  p2p& operator=(p2p&&) noexcept;
  p2p(p2p_config config, random_stream rng, instant now);

  void on_link_open(link_id link, link_role role, instant now,
                    std::optional<attempt_id> attempt = std::nullopt);
  void on_attempt_failed(attempt_id attempt, instant now);
  /// @param from the sender's address, if it has one
  void on_announcement(byte_view octets, instant now,
                       std::optional<ipv4_address> from = std::nullopt);
  void on_bluetooth_scan(std::string_view adapter, std::span<const seen_device> seen, instant now);
  void on_hello_answer(std::string_view adapter, const bluetooth_address& address, byte_view octets,
                       instant now);
  void on_link_octets(link_id link, byte_view octets, instant now); ///< handled by serve_next()
  void on_link_sent(link_id link, std::size_t octets, instant now);
  void on_link_closed(link_id link, instant now);
  void on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Handles some of what links have brought: of one link, whose turn it is. To be called until it
  /// returns false, then end_turn(); what is left then is due at once, or when its neighbour is
  /// within its budget again.
  bool serve_next(instant now);
  [[nodiscard]] bool has_input() const;
  void end_turn(instant now);

  /// What came over a link has cost us more than its receipt: the neighbour's budget pays. Nothing
  /// for a link that is gone.
  void charge(link_id link, work_units work, instant now);

  void send(posting x);

  /// To every peer that can be reached; up to 1024 octets.
  [[nodiscard]] cause broadcast(std::uint16_t port, payload octets);

  /// Messages that are being put together take of this memory as well. @pre nothing has come yet
  void share_memory(std::shared_ptr<fair_share> x);

  /// Shows packages of others that pass through, broadcasts included, but no parts of longer
  /// messages (API-06). What is consumed goes no further; if its sender waits for its
  /// acknowledgement, it comes again. An empty hook ends it.
  void set_transit_hook(std::uint16_t port, transit_hook hook);

  /// The exit broadcast (peis-wire.md 11). No routing is sent from then on.
  void leave();

  /// Where we listen from now on, as p2p_config::addresses: others are notified at once.
  void set_addresses(std::vector<low_level_address> all, instant now);

  /// Which route packages take to that host and back. Output as `traced`, within trace_timeout.
  void trace(peer_id destination, request_id id, instant now);

  /// The local clock was set: by so much more than time has passed.
  void step_clock(duration by, instant now);

  /// What has happened since the last call; without to_link.
  [[nodiscard]] events take_events();

  /// Writes what the links have room for. Adds to_link events, and others.
  void flush(instant now);

  [[nodiscard]] p2p_view view() const;

private:
  struct parts;

  std::unique_ptr<parts> parts_; ///< they refer to each other: they stay where they are
};

} // namespace rubicon::peis
