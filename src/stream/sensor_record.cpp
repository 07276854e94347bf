#include "stream/sensor_record.hpp"

#include "core/codec.hpp"

namespace rubicon::stream {

bytes encode(const sensor_record& x) {
  byte_writer to;
  to.big(x.source.island.value).big(x.source.mote.value).big(x.time_ms).big(x.value);
  return to.finish();
}

result<sensor_record> decode_sensor_record(byte_view octets) {
  byte_reader from(octets);
  sensor_record x;
  x.source.island = island_id{from.big<std::uint32_t>()};
  x.source.mote = mote_id{from.big<std::uint16_t>()};
  x.time_ms = from.big<std::uint32_t>();
  x.value = from.big<std::int16_t>();
  if (!from.ok())
    return errc::truncated;
  if (from.remaining() > 0)
    return errc::too_long;
  return x;
}

} // namespace rubicon::stream
