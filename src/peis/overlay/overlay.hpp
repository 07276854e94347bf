// Over which link packages for a host leave (peis-wire.md 9).
#pragma once

#include <map>
#include <optional>

#include "core/time.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/overlay/routing_table.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// A link to the host itself, else what the routing table says; without either, the link over which
/// the host last sent something.
class overlay {
public:
  /// Both outlive this.
  overlay(const own_peer& own, link_table& links);

  [[nodiscard]] std::optional<link_id> next_hop(peer_id destination) const;
  /// The next hop, or where packages of that host last came from: an answer does not wait for
  /// routes to a host that has just come (P2P-09).
  [[nodiscard]] std::optional<link_id> any_hop(peer_id destination) const;
  [[nodiscard]] bool reachable(peer_id host) const { return next_hop(host).has_value(); }
  /// The next hop, then all others that are offered, in doubt or not, the best first.
  [[nodiscard]] std::vector<link_id> hops_to(peer_id destination) const;

  /// A package of that host came over this link.
  void note_source(peer_id source, link_id over);
  void forget_source(peer_id source) { sources_.erase(source); }
  [[nodiscard]] routing_changes on_link_closed(link_id link, instant now);

  [[nodiscard]] routing_table& routes() { return routes_; }
  [[nodiscard]] const routing_table& routes() const { return routes_; }

private:
  const own_peer& own_;
  link_table& links_;
  routing_table routes_;
  std::map<peer_id, link_id> sources_; ///< those without a route
};

} // namespace rubicon::peis
