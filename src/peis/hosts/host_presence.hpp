// Which hosts are there, for the kernel above: both a route to a host and its record are.
#pragma once

#include "core/time.hpp"
#include "peis/hosts/host_inquiry.hpp"
#include "peis/hosts/route_tracer.hpp"
#include "peis/hosts/routing_exchange.hpp"
#include "peis/link/traffic_meter.hpp"
#include "peis/links/announcer.hpp"
#include "peis/links/contact_history.hpp"
#include "peis/links/message_delivery.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Carries out what changes of the routes bring about.
class host_presence {
public:
  /// What a host is concerned by. All outlive this.
  struct concerned {
    own_peer& own;
    overlay& routes;
    routing_exchange& exchange;
    host_table& hosts;
    host_inquiry& inquiry;
    message_delivery& messages;
    route_tracer& tracer;
    contact_history& contacts;
    traffic_meter& traffic;
    announcer& announcements;
  };
  explicit host_presence(const concerned& all) : on_(all) {}

  void apply(const routing_changes& changes, const occasion& x);
  /// The record of a host, or a link to it, is new.
  void welcome(peer_id id, const occasion& x);
  /// What it has subscribed to here is gone, and what we had of it: it is notified.
  void notify_forgotten(peer_id id, const occasion& x);
  /// Ends everything that concerns a host but the routes to it.
  void forget(peer_id id, const occasion& x);
  /// Who answers at a loopback address of that host is another one.
  void note_elsewhere(peer_id host, const occasion& x);

private:
  void update_cluster(const occasion& x);

  concerned on_;
};

} // namespace rubicon::peis
