// Which links to open and to close: clusters, the connection manager, who may have a link (A9,
// peis-wire.md 14).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "peis/hosts/routing_exchange.hpp"
#include "peis/link/link.hpp"
#include "peis/link/traffic_meter.hpp"
#include "peis/links/contact_history.hpp"
#include "peis/links/dialler.hpp"
#include "peis/links/link_health.hpp"
#include "peis/overlay/connection_manager.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/overlay.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/p2p/link_closer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

class matchmaker {
public:
  /// What is known of links and hosts, and what opens and closes them. All outlive this.
  struct means {
    own_peer& own;
    const link_table& links;
    const overlay& routes;
    routing_exchange& exchange;
    host_table& hosts;
    const link_health& health;
    contact_history& contacts;
    traffic_meter& traffic;
    dialler& dials;
    link_closer& closer;
  };
  matchmaker(const means& all, instant now)
      : of_(all), next_manager_(now + all.own.config.connections.manager_period), next_merge_(now) {
  }

  /// May the peer that asks have a link? Closes another for it if that is worth less (CM-09).
  [[nodiscard]] bool has_room_for(const connect_request& request, const occasion& x);

  /// There is a host without a route.
  void hasten_merge(instant now);
  void on_time(const occasion& x);
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  [[nodiscard]] bool manages() const;
  [[nodiscard]] bool manager_wanted() const;
  void manage(const occasion& x);
  void merge_clusters(const occasion& x);
  void close_doubles(const occasion& x);
  [[nodiscard]] bool is_better(const connection& a, const connection& b, instant now) const;
  [[nodiscard]] bool force_by_traffic(const occasion& x);
  [[nodiscard]] bool replace_least(const occasion& x);
  [[nodiscard]] bool busy_with(peer_id host) const;
  [[nodiscard]] std::vector<link_option> link_options(instant now) const;
  [[nodiscard]] std::vector<host_option> host_options(bool full_ones, instant now);
  [[nodiscard]] bool is_lasting(const connection& x) const;
  void release(std::span<const link_option> links, const occasion& x);
  [[nodiscard]] bool tend_drain(const link_option& x, const occasion& at);

  means of_;
  instant next_manager_;
  instant next_merge_;
  instant last_merge_;
  instant next_judgement_; ///< of links, for others that ask
};

} // namespace rubicon::peis
