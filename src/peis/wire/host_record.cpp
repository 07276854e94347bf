#include "peis/wire/host_record.hpp"

#include <algorithm>
#include <cassert>

#include "core/codec.hpp"
#include "peis/wire/layout.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t name_size = 64;
constexpr std::size_t count_at = 136;
constexpr std::size_t addresses_at = 144;
constexpr std::size_t address_size = 24;
constexpr std::size_t device_size = 8;
constexpr std::size_t cached_at = 544;

low_level_address decode_address(byte_view octets) {
  low_level_address x;
  const auto device = octets.first(device_size);
  x.device = rubicon::to_string(device);
  x.device.resize(std::min(x.device.find('\0'), x.device.size())); // no NUL if 8 characters
  x.loopback = octets[8] != 0;
  // The only integer of the record in little-endian order (peis-wire.md 5).
  x.type = static_cast<low_level_address::kind>(
      byte_reader(octets.subspan(12, 4)).little<std::uint32_t>());
  std::copy_n(octets.begin() + 16, x.address.size(), x.address.begin());
  return x;
}

} // namespace

void encode(const host_record& record, bytes& out) {
  assert(record.addresses.size() <= low_level_addresses_max);
  layout_writer<host_record_size> to;
  to.big(0, record.id.value).big(4, record.magic);
  to.text(8, name_size, record.host_name).text(72, name_size, record.full_name);
  to.octet(count_at, static_cast<std::uint8_t>(record.addresses.size()));
  std::size_t at = addresses_at;
  for (const auto& x : record.addresses) {
    to.text(at, device_size + 1, x.device).octet(at + 8, x.loopback ? 1 : 0);
    for (unsigned i = 0; i < 4; ++i)
      to.octet(at + 12 + i,
               static_cast<std::uint8_t>(static_cast<std::uint32_t>(x.type) >> (8 * i)));
    to.copy(at + 16, x.address);
    at += address_size;
  }
  to.big(536, record.cluster).big(540, record.marked ? liveness_mark : 0U);
  to.append_to(out);
}

result<host_record> decode_host_record(byte_view octets) {
  if (octets.size() < host_record_size)
    return errc::truncated;
  const layout_reader from(octets);
  const std::size_t count = from.octet(count_at);
  if (count > low_level_addresses_max)
    return errc::too_long;
  const auto host_name = from.text(8, name_size);
  const auto full_name = from.text(72, name_size);
  host_record record;
  record.id = peer_id{from.big<std::int32_t>(0)};
  if (!host_name || !full_name || record.id.value <= 0)
    return errc::bad_value;
  record.magic = from.big<std::int32_t>(4);
  record.host_name = *host_name;
  record.full_name = *full_name;
  for (std::size_t i = 0; i < count; ++i)
    record.addresses.push_back(
        decode_address(octets.subspan(addresses_at + i * address_size, address_size)));
  record.cluster = from.big<std::int32_t>(536);
  record.marked = from.big<std::uint32_t>(540) == liveness_mark;
  return record;
}

void hide_inproc(std::span<std::uint8_t> octets) {
  if (octets.size() < host_record_size)
    return;
  const std::size_t count = std::min<std::size_t>(octets[count_at], low_level_addresses_max);
  auto* const first = octets.data() + addresses_at;
  auto* kept = first;
  for (std::size_t i = 0; i < count; ++i) {
    const auto* const x = first + i * address_size;
    if (decode_address(byte_view(x, address_size)).type == low_level_address::kind::inproc)
      continue;
    std::copy_n(x, address_size, kept);
    kept += address_size;
  }
  std::fill(kept, first + count * address_size, std::uint8_t{0});
  octets[count_at] = static_cast<std::uint8_t>((kept - first) / static_cast<int>(address_size));
}

bytes encode(const host_record_message& message) {
  bytes out;
  out.reserve(host_record_message_size);
  encode(message.record, out);
  out.push_back(message.cached ? 1 : 0);
  out.resize(host_record_message_size);
  return out;
}

result<host_record_message> decode_host_record_message(byte_view octets) {
  if (octets.size() < host_record_message_size)
    return errc::truncated;
  auto record = decode_host_record(octets);
  if (!record)
    return record.error();
  return host_record_message{std::move(*record), octets[cached_at] != 0};
}

} // namespace rubicon::peis
