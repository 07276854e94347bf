// What becomes of a package: it is dropped, handled or passed on (peis-wire.md 6 and 7).
#pragma once

#include "core/bytes.hpp"
#include "peis/delivery/seen_ids.hpp"
#include "peis/hosts/clock_service.hpp"
#include "peis/hosts/host_inquiry.hpp"
#include "peis/hosts/route_tracer.hpp"
#include "peis/link/traffic_meter.hpp"
#include "peis/links/heartbeats.hpp"
#include "peis/links/message_delivery.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/overlay/transit_hooks.hpp"
#include "peis/p2p/id_guard.hpp"
#include "peis/p2p/incarnations.hpp"
#include "peis/p2p/introductions.hpp"
#include "peis/p2p/own_id.hpp"
#include "peis/p2p/routing_updates.hpp"
#include "peis/wire/package.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

class package_handler {
public:
  /// Where packages are handed to. All outlive this.
  struct services {
    own_peer& own;
    link_table& links;
    overlay& routes;
    seen_ids& seen;
    package_sender& sender;
    traffic_meter& traffic;
    message_delivery& messages;
    const transit_hooks& hooks;
    route_tracer& tracer;
    clock_service& clock;
    heartbeats& beats;
    host_inquiry& inquiry;
    const id_guard& guard;
    own_id& duplicates;
    incarnations& records;
    introductions& names;
    routing_updates& updates;
  };
  explicit package_handler(const services& all) : to_(all) {}

  /// The link may be gone afterwards.
  void on_package(link_id from, const package_header& header, byte_view data, const occasion& x);

private:
  [[nodiscard]] bool is_new(link_id from, const package_header& header, const occasion& x);
  void on_fragment(link_id from, const package_header& header, byte_view data, const occasion& x);
  void serve(link_id from, const package_header& header, byte_view data, const occasion& x);
  void serve_neighbour(link_id from, const package_header& header, byte_view data,
                       const occasion& x);
  [[nodiscard]] bool is_consumed(const package_header& header, byte_view data, events& out);
  void forward(link_id from, package_header header, byte_view data);

  services to_;
};

} // namespace rubicon::peis
