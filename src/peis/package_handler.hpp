// What becomes of a package: it is dropped, handled or passed on (peis-wire.md 6 and 7).
#pragma once

#include "core/bytes.hpp"
#include "peis/clock_service.hpp"
#include "peis/heartbeats.hpp"
#include "peis/host_inquiry.hpp"
#include "peis/id_guard.hpp"
#include "peis/incarnations.hpp"
#include "peis/introductions.hpp"
#include "peis/link_table.hpp"
#include "peis/message_delivery.hpp"
#include "peis/occasion.hpp"
#include "peis/overlay.hpp"
#include "peis/own_id.hpp"
#include "peis/own_peer.hpp"
#include "peis/package.hpp"
#include "peis/package_sender.hpp"
#include "peis/route_tracer.hpp"
#include "peis/routing_updates.hpp"
#include "peis/seen_ids.hpp"
#include "peis/traffic_meter.hpp"
#include "peis/transit_hooks.hpp"
#include "peis/types.hpp"

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
