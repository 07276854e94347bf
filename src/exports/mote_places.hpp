// Where the motes and sinks of a recorded run are.
#pragma once

#include <string>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "device/walk.hpp"

namespace rubicon::exports {

/// A mote or sink that stands or is carried.
struct mote_place {
  mote_address who;
  device::walk path; ///< of one that stands: one point
};

/// @param ecology message `ecology` of docs/view.md, as a record has it; what is none has no motes
[[nodiscard]] std::vector<mote_place> places_of(const std::string& ecology);

} // namespace rubicon::exports
