// Closes links, and what depends on each.
#pragma once

#include <vector>

#include "peis/delivery/seen_ids.hpp"
#include "peis/hosts/host_presence.hpp"
#include "peis/links/contact_history.hpp"
#include "peis/links/dialler.hpp"
#include "peis/links/link_health.hpp"
#include "peis/links/link_input.hpp"
#include "peis/links/message_delivery.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

class link_closer {
public:
  /// What a link is part of. All outlive this.
  struct concerned {
    own_peer& own;
    link_table& links;
    link_input& input;
    const link_health& health;
    seen_ids& seen;
    contact_history& contacts;
    dialler& dials;
    message_delivery& messages;
    overlay& routes;
    host_presence& presence;
  };
  explicit link_closer(const concerned& all) : on_(all) {}

  void close(link_id link, close_cause why, const occasion& x);
  /// Links that are of no use any more.
  void close_broken(const std::vector<link_id>& links, close_cause why, const occasion& x);
  /// The other end has closed it.
  void on_closed(connection& gone, const occasion& x);

private:
  void forget(link_id link, const occasion& x);

  concerned on_;
};

} // namespace rubicon::peis
