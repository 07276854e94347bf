// The record of a sensor stream: (nid, ts, val) of D1.1 3.3.2.2 (STR-07).
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::stream {

/// 12 octets: uint32 island, uint16 mote, uint32 time, int16 value; network byte order.
struct sensor_record {
  mote_address source;
  std::uint32_t time_ms = 0; ///< network time of the sample
  std::int16_t value = 0;    ///< in counts of the transducer

  static constexpr std::size_t size = 12;

  friend bool operator==(const sensor_record&, const sensor_record&) = default;
};

[[nodiscard]] bytes encode(const sensor_record& x);

/// Errors: truncated, too_long.
[[nodiscard]] result<sensor_record> decode_sensor_record(byte_view octets);

} // namespace rubicon::stream
