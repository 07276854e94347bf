// Where a mote that moves is at some moment.
#pragma once

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::device {

struct waypoint {
  duration at{}; ///< since the start of the run
  position place;
};

} // namespace rubicon::device
