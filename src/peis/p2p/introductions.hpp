// Host records that come over links: who is at the other end of each.
#pragma once

#include "core/bytes.hpp"
#include "peis/hosts/host_presence.hpp"
#include "peis/links/dialler.hpp"
#include "peis/links/link_health.hpp"
#include "peis/links/link_writer.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/p2p/id_guard.hpp"
#include "peis/p2p/incarnations.hpp"
#include "peis/p2p/link_closer.hpp"
#include "peis/p2p/link_greeting.hpp"
#include "peis/p2p/own_id.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

/// The first to describe itself over a link is the neighbour there, for good.
class introductions {
public:
  /// What a record concerns. All outlive this.
  struct concerned {
    own_peer& own;
    link_table& links;
    overlay& routes;
    const host_table& hosts;
    package_sender& sender;
    link_writer& writer;
    const link_health& health;
    dialler& dials;
    host_presence& presence;
    link_closer& closer;
    id_guard& guard;
    own_id& duplicates;
    link_greeting& greeting;
    incarnations& records;
  };
  explicit introductions(const concerned& all) : on_(all) {}

  /// The link may be gone afterwards.
  void on_record(link_id from, const package_header& header, byte_view data, const occasion& x);

private:
  void introduce(link_id from, const package_header& header, const host_record_message& message,
                 const occasion& x);
  void name(connection& x, const host_record& record, const occasion& at);
  void show_ourselves(connection& to, const occasion& x);
  void note_beyond(link_id from, const package_header& header, const host_record& record,
                   const occasion& x);

  concerned on_;
};

} // namespace rubicon::peis
