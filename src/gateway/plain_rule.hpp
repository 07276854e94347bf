// What a file may say about motes that run plain programs of TinyOS.
#pragma once

#include <cstdint>

#include "core/address.hpp"

namespace rubicon::gateway {

/// Packets of one AM type from some motes are messages of devices.
struct plain_rule {
  std::uint8_t am_type = 0;
  std::uint16_t first = 1;          ///< addresses of the motes: from this one
  std::uint16_t last = mote_id_max; ///< to this one
  std::uint32_t type = 0;           ///< as which they are devices
  std::uint8_t channel = 1;         ///< of their output that has the payload
};

} // namespace rubicon::gateway
