// How gateways write the messages that they pass to each other (WIR-02, WIR-04).
#pragma once

#include <cstdint>

namespace rubicon {

/// What stands behind the header of D1.1 5.4.
enum class wire_form : std::uint8_t {
  strict54 = 0, ///< the user payload: who sent it within its island is unknown (A-51)
  segment = 1,  ///< a transport::segment, as between our own
};

} // namespace rubicon
