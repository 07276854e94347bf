// Hosts that have left, are lost for too long, or were restarted (peis-wire.md 9 to 11).
#pragma once

#include <cstdint>

#include "peis/hosts/host_presence.hpp"
#include "peis/hosts/routing_exchange.hpp"
#include "peis/links/contact_history.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/p2p/link_closer.hpp"
#include "peis/wire/dead_host.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

class host_removal {
public:
  /// What a host is part of. All outlive this.
  struct concerned {
    const own_peer& own;
    const link_table& links;
    overlay& routes;
    routing_exchange& exchange;
    host_table& hosts;
    contact_history& contacts;
    host_presence& presence;
    link_closer& closer;
  };
  explicit host_removal(const concerned& all) : on_(all) {}

  /// Gives a host up: it has said that it exits (message), or it was lost for too long (route).
  void remove(peer_id id, dead_host_message::reason why, const occasion& x);
  /// Another incarnation has taken the place of this one, whose links lead nowhere.
  void supersede(peer_id id, std::int32_t magic, const occasion& x);

private:
  concerned on_;
};

} // namespace rubicon::peis
