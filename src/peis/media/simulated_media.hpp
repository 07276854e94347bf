// What simulated media of links, LAN and Bluetooth, send the processes that use them.
#pragma once

#include <cstdint>

#include "core/describe/fields.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

struct station_tag;

/// A process on a computer, named by the owner of the medium; never used twice.
using station_id = strong_id<station_tag, std::uint64_t>;

/// What the simulated network does to a link.
struct link_condition {
  bool cut = false; ///< nothing gets through
  double loss = 0;  ///< chance that a package is lost, 0..1

  friend bool operator==(const link_condition&, const link_condition&) = default;
};
RUBICON_FIELDS(link_condition, cut, loss);

/// A link is up. Sent to the acceptor first: it must know the link before the initiator's first
/// octets arrive.
struct link_made {
  station_id station; ///< the receiver, as in all that follow
  station_id other;   ///< the far end
  link_id link;
  link_role role = link_role::initiator;
  attempt_id attempt; ///< the initiator's; 0 for an acceptor
  link_condition condition = {};
};

/// No station accepted the link that was asked for.
struct link_refused {
  station_id station;
  attempt_id attempt;
};

/// The link is gone.
struct link_reset {
  station_id station;
  link_id link;
};

} // namespace rubicon::peis
