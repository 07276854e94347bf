// Which incarnation of a host is there now (peis-wire.md 10, RTE-08, KH-01, KH-02).
//
// Magic numbers are random: two of them do not show which is the later one. What shows it are the
// routes, because only who lives raises its sequence number, and overtakes an earlier incarnation
// as soon as it receives it; and the word of a host about itself, unless a route that has been
// renewed since contradicts it. A record that another host remembers counts only if it fits the
// route.
#pragma once

#include <optional>

#include "core/bytes.hpp"
#include "core/text/ipv4_network.hpp"
#include "peis/hosts/host_inquiry.hpp"
#include "peis/hosts/host_presence.hpp"
#include "peis/hosts/routing_exchange.hpp"
#include "peis/links/announcer.hpp"
#include "peis/links/contact_history.hpp"
#include "peis/links/dialler.hpp"
#include "peis/links/heartbeats.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/p2p/host_removal.hpp"
#include "peis/p2p/id_guard.hpp"
#include "peis/p2p/matchmaker.hpp"
#include "peis/p2p/own_id.hpp"
#include "peis/wire/announcement.hpp"
#include "peis/wire/host_record.hpp"

namespace rubicon::peis {

class incarnations {
public:
  /// What news of a host concerns. All outlive this.
  struct concerned {
    own_peer& own;
    const link_table& links;
    const overlay& routes;
    routing_exchange& exchange;
    host_table& hosts;
    host_inquiry& inquiry;
    contact_history& contacts;
    const dialler& dials;
    heartbeats& beats;
    announcer& announcements;
    host_presence& presence;
    host_removal& removal;
    const id_guard& guard;
    own_id& duplicates;
    matchmaker& matches;
  };
  explicit incarnations(const concerned& all) : on_(all) {}

  void on_record(const host_record_message& message, const occasion& x);
  void on_dead_host(const package_header& header, byte_view data, const occasion& x);
  /// @param from the sender's address, if it has one
  void on_announcement(byte_view octets, std::optional<ipv4_address> from, const occasion& x);

private:
  [[nodiscard]] bool believes(const host_record_message& message, instant now) const;
  void store(const host_record_message& message, host_entry& stored, std::int32_t before,
             const occasion& x);
  void note_sender(const host_record& sender, std::optional<ipv4_address> from, const occasion& x);

  concerned on_;
};

} // namespace rubicon::peis
