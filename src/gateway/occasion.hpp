// One call of a gateway, for its parts.
#pragma once

#include "core/time.hpp"
#include "gateway/gateway_config.hpp"
#include "gateway/outputs.hpp"

namespace rubicon::gateway {

/// When it is, where outputs are appended, and where is counted.
struct occasion {
  instant now;
  outputs& out;
  gateway_counters& counters;
  bool of_plain = false; ///< the reason is a packet of a mote with a plain program
};

} // namespace rubicon::gateway
