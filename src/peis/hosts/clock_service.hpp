// Messages of the clock that all peers share (peis-wire.md 12, KH-05).
#pragma once

#include <optional>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/links/package_sender.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/link_table.hpp"
#include "peis/overlay/network_clock.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Sends the broadcasts of network_clock. Marked peers add to one that passes how long it was on
/// its last link. In a large network the first of those that would begin at once quiets most
/// others.
class clock_service {
public:
  /// All outlive this.
  clock_service(own_peer& own, const link_table& links, const host_table& hosts,
                package_sender& sender, instant now);

  void on_message(link_id from, const package_header& header, byte_view data, instant now);
  /// What goes on of a broadcast.
  [[nodiscard]] bytes relayed(link_id from, const package_header& header, byte_view data) const;
  void on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return clock_.deadline(); }

  [[nodiscard]] network_clock& clock() { return clock_; }
  [[nodiscard]] const network_clock& clock() const { return clock_; }

private:
  [[nodiscard]] bool measures_route(const package_header& header) const;

  own_peer& own_;
  const link_table& links_;
  const host_table& hosts_;
  package_sender& sender_;
  network_clock clock_;
  bool broadcasts_ = false; ///< since it was last quiet
};

} // namespace rubicon::peis
