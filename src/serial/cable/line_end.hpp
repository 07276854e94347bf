// What either end of a serial line asks of its owner.
#pragma once

#include "core/account/provenance.hpp"
#include "core/bytes.hpp"

namespace rubicon::serial {

/// Write these octets, one or more whole frames, in one go.
struct to_line {
  bytes octets;
  provenance from = {};
};

/// A packet has come over the line with a good CRC.
struct received {
  bytes packet; ///< dispatch octet first, never empty
};

} // namespace rubicon::serial
