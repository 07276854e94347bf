// When, why and for whom a part of the network layer is called.
#pragma once

#include "core/time.hpp"
#include "peis/link/outgoing_queue.hpp"
#include "peis/overlay/p2p_events.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

struct occasion {
  instant now;
  events& out;                 ///< what comes of it is appended here
  link_id origin = own_origin; ///< the link over which its reason has come

  /// The same, with a reason that has come over this link.
  [[nodiscard]] occasion over(link_id link) const { return {now, out, link}; }
};

} // namespace rubicon::peis
