// Where a mote that moves is at some moment.
#pragma once

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::mote {

struct way_point {
  duration at{}; ///< since the start of the run
  position place;
};

} // namespace rubicon::mote
