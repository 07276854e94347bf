// Links that open: who may have one, and what both ends send first (peis-wire.md 3).
#pragma once

#include <optional>

#include "core/bytes.hpp"
#include "peis/hosts/host_presence.hpp"
#include "peis/hosts/routing_exchange.hpp"
#include "peis/links/dialler.hpp"
#include "peis/links/heartbeats.hpp"
#include "peis/links/link_health.hpp"
#include "peis/links/link_writer.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/id_rivalry.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/p2p/link_closer.hpp"
#include "peis/p2p/matchmaker.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

class link_greeting {
public:
  /// What a new link becomes part of. All outlive this.
  struct concerned {
    own_peer& own;
    const id_rivalry& rivalry;
    link_table& links;
    overlay& routes;
    routing_exchange& exchange;
    const host_table& hosts;
    package_sender& sender;
    link_writer& writer;
    link_health& health;
    heartbeats& beats;
    dialler& dials;
    host_presence& presence;
    link_closer& closer;
    matchmaker& matches;
  };
  explicit link_greeting(const concerned& all) : on_(all) {}

  /// @returns false if the link is there already, or refused
  bool open(link_id link, link_role role, std::optional<attempt_id> made, const occasion& x);
  /// Decides on a connect request (peis-wire.md 3.2). The link may be gone afterwards.
  void accept(connection& from, byte_view request, const occasion& x);
  /// The link leads to this host.
  void bind(connection& x, peer_id neighbour, const occasion& at);

private:
  [[nodiscard]] std::optional<close_cause> why_no_link(bool late, link_role role) const;
  [[nodiscard]] std::optional<close_cause>
  why_refused(const result<connect_request>& request) const;
  void greet(connection& to, const occasion& x);
  void refer_elsewhere(connection& to, const occasion& x);
  void refuse_own_id(connection& to, const occasion& x);
  void evict_greeting(const occasion& x);

  concerned on_;
};

} // namespace rubicon::peis
