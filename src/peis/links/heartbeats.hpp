// Signs of life between marked neighbours (KH-05, peis-wire.md 13).
#pragma once

#include <optional>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/links/link_health.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/own_peer.hpp"

namespace rubicon::peis {

/// One for each link on which nothing else leaves. The round trip is measured with them.
class heartbeats {
public:
  /// All outlive this.
  heartbeats(own_peer& own, link_table& links, const host_table& hosts, link_health& health,
             package_sender& sender)
      : own_(own), links_(links), hosts_(hosts), health_(health), sender_(sender) {}

  void expect(const connection& x); ///< the link, or its neighbour's mark, is new
  void on_heartbeat(connection& x, byte_view data, instant now);
  void on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return next_; }

private:
  [[nodiscard]] instant next_of(const connection& x) const;
  [[nodiscard]] duration lead() const;
  void send(connection& x, instant now, link_id origin);

  own_peer& own_;
  link_table& links_;
  const host_table& hosts_;
  link_health& health_;
  package_sender& sender_;
  std::optional<instant> next_;
};

} // namespace rubicon::peis
