// What changes as time passes and neighbours send their routes.
#pragma once

#include <optional>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/hosts/host_inquiry.hpp"
#include "peis/hosts/host_presence.hpp"
#include "peis/hosts/routing_exchange.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/overlay/route_probes.hpp"
#include "peis/p2p/host_removal.hpp"
#include "peis/p2p/link_replacer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Enters tables, disproves and ages routes, and gives hosts up to which there has been none for
/// too long.
class routing_updates {
public:
  /// What routes concern. All outlive this.
  struct concerned {
    own_peer& own;
    link_table& links;
    overlay& routes;
    routing_exchange& exchange;
    host_table& hosts;
    host_inquiry& inquiry;
    host_presence& presence;
    host_removal& removal;
    link_replacer& replacer;
  };
  explicit routing_updates(const concerned& all) : on_(all) {}

  void on_page(link_id from, byte_view data, const occasion& x);
  void apply_waiting(const occasion& x); ///< tables that came too soon
  void on_period(const occasion& x);     ///< if one is over
  /// The route to this host leads nowhere.
  void disprove(const way_disproved& x, const occasion& at);
  /// A package of this host has come.
  void on_sign_of_life(peer_id host, const occasion& x);
  /// A marked host to which no route is left is not waited for.
  void remove_lost(const occasion& x);
  [[nodiscard]] std::optional<instant> loss_deadline() const;

private:
  void apply_table(connection& from, const occasion& x);

  concerned on_;
};

} // namespace rubicon::peis
