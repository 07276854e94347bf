#include "peis/wire/acknowledgement.hpp"

#include <cassert>

#include "core/codec.hpp"

namespace rubicon::peis {

bytes encode_acknowledgement(std::span<const std::int32_t> ack_ids) {
  assert(ack_ids.size() <= acknowledgements_max);
  byte_writer to;
  to.big(static_cast<std::uint32_t>(ack_ids.size()));
  for (const auto id : ack_ids)
    to.big(id);
  return to.finish();
}

result<std::vector<std::int32_t>> decode_acknowledgement(byte_view octets) {
  byte_reader from(octets);
  const std::size_t count = from.big<std::uint32_t>();
  if (count > acknowledgements_max)
    return errc::too_long;
  std::vector<std::int32_t> ids(count);
  for (auto& id : ids)
    id = from.big<std::int32_t>();
  if (!from.ok())
    return errc::truncated;
  return ids;
}

} // namespace rubicon::peis
