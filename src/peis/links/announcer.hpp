// When a peer announces itself to the group that all peers receive (peis-wire.md 4).
#pragma once

#include <optional>

#include "core/time.hpp"
#include "peis/overlay/host_table.hpp"
#include "peis/overlay/id_rivalry.hpp"
#include "peis/overlay/occasion.hpp"
#include "peis/overlay/own_peer.hpp"
#include "peis/overlay/p2p_events.hpp"

namespace rubicon::peis {

/// Every peer announces three times that it has come. From then on only the one with the lowest id
/// of each machine goes on, the more rarely the more hosts it knows: each peer receives them all.
class announcer {
public:
  /// All outlive this.
  announcer(own_peer& own, const id_rivalry& rivalry, const host_table& hosts, instant now)
      : own_(own), rivalry_(rivalry), hosts_(hosts), next_(now) {}

  void hasten(instant now) { next_ = now; }
  void on_better_announcer() { quiet_periods_ = 0; } ///< of our machine
  void announce_now(const occasion& x);              ///< beside those of each period
  void on_time(const occasion& x);
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  [[nodiscard]] bool may_announce() const;
  [[nodiscard]] duration period();
  void announce(events& out);

  own_peer& own_;
  const id_rivalry& rivalry_;
  const host_table& hosts_;
  instant next_;
  unsigned first_ = 0;         ///< made, of those at the start
  unsigned quiet_periods_ = 0; ///< without a better announcer
};

} // namespace rubicon::peis
