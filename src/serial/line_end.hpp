// What either end of a serial line asks of its owner.
#pragma once

#include "core/bytes.hpp"
#include "core/provenance.hpp"

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
