#include "peis/wire/announcement.hpp"

#include "peis/wire/layout.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t network_at = 8;
constexpr std::size_t network_octets = 64;
constexpr std::size_t record_at = 72;

} // namespace

bytes encode(const announcement& x) {
  layout_writer<record_at> to;
  to.big(0, x.version).text(network_at, network_octets, x.network);
  bytes out;
  out.reserve(announcement_size);
  to.append_to(out);
  encode(x.sender, out);
  return out;
}

void hide_inproc_of_announcement(std::span<std::uint8_t> octets) {
  if (octets.size() == announcement_size)
    hide_inproc(octets.subspan(record_at));
}

result<announcement> decode_announcement(byte_view octets) {
  if (octets.size() != announcement_size)
    return octets.size() < announcement_size ? errc::truncated : errc::too_long;
  const layout_reader from(octets);
  const auto network = from.text(network_at, network_octets);
  if (!network)
    return errc::bad_value;
  auto sender = decode_host_record(octets.subspan(record_at));
  if (!sender)
    return sender.error();
  return announcement{from.big<std::int32_t>(0), std::string(*network), std::move(*sender)};
}

} // namespace rubicon::peis
