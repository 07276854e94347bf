// Another peer uses our id (peis/overlay/id_rivalry.hpp).
#pragma once

#include <optional>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/hosts/host_presence.hpp"
#include "peis/hosts/routing_exchange.hpp"
#include "peis/links/dialler.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/id_rivalry.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/p2p/host_removal.hpp"
#include "peis/p2p/link_closer.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

/// Carries out what id_rivalry decides: we keep our id, or keep off the network for a while.
class own_id {
public:
  /// What keeping off the network concerns. All outlive this.
  struct concerned {
    own_peer& own;
    id_rivalry& rivalry;
    link_table& links;
    const overlay& routes;
    routing_exchange& exchange;
    const host_table& hosts;
    dialler& dials;
    host_presence& presence;
    link_closer& closer;
    host_removal& removal;
  };
  explicit own_id(const concerned& all) : on_(all) {}

  void note_duplicate(const host_record& other, const occasion& x);
  [[nodiscard]] bool is_away() const { return on_.rivalry.is_away(); } ///< off the network
  /// A package with our id as its source: the other end of a link may answer with it.
  void on_package(link_id from, const package_header& header, byte_view data, const occasion& x);
  void on_time(const occasion& x);

private:
  void apply(id_rivalry::outputs todo, const occasion& x);
  void vacate(const occasion& x);

  concerned on_;
};

} // namespace rubicon::peis
