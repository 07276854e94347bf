// What a mote says about itself when it joins (DIS-01, DIS-09): type-length-value fields, so that a
// reader skips what it does not know.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "device/transducer_config.hpp"

namespace rubicon::mote {

/// Fields: tag 1, uint32 type; tag 2, uint32 transducer mask; tag 3, uint32 actuator mask; tag 4,
/// uint32 keep-alive period in ms; tag 5, uint32 device, if known. One octet tag, one octet length,
/// value in network byte order.
struct descriptor {
  std::uint32_t type = 0;            ///< signature of the mote's proxy class (PXY-13)
  std::uint32_t transducer_mask = 0; ///< bit n: device::quantity n
  std::uint32_t actuator_mask = 0;   ///< bit n: device::actuator_kind n
  std::uint32_t keep_alive_ms = 0;   ///< the mote sends about this often; 0: not promised
  std::uint32_t device = 0; ///< the low bits of the serial number of its hardware; 0: unknown

  friend bool operator==(const descriptor&, const descriptor&) = default;
};

inline constexpr std::size_t device_field_size = 6; ///< which comes last, if it is known

[[nodiscard]] bytes encode(const descriptor& x);

/// Errors: truncated, bad_value (a known field of the wrong length), unsupported (no type field).
[[nodiscard]] result<descriptor> decode_descriptor(byte_view octets);

} // namespace rubicon::mote
