#include "peis/wire/package.hpp"

#include "peis/wire/layout.hpp"

namespace rubicon::peis {

namespace {

constexpr std::uint32_t sync_word = 0xff00aa00;

} // namespace

void encode(const package_header& header, bytes& out) {
  layout_writer<header_size> to;
  to.big(0, sync_word).big(4, header.id).big(8, header.counter).big(12, header.ack_id);
  to.big(16, header.flags).octet(18, static_cast<std::uint8_t>(header.type));
  to.octet(19, header.hops).big(20, header.source.value).big(24, header.destination.value);
  to.big(28, header.port).big(30, header.length);
  to.big(32, header.seqlen).big(34, header.seqid).big(36, header.seqnum);
  to.append_to(out);
}

result<package_header> decode_header(byte_view octets) {
  if (octets.size() < header_size)
    return errc::truncated;
  const layout_reader from(octets);
  package_header header;
  header.id = from.big<std::int32_t>(4);
  header.counter = from.big<std::uint32_t>(8);
  header.ack_id = from.big<std::int32_t>(12);
  header.flags = from.big<std::uint16_t>(16);
  header.type = static_cast<package_type>(from.octet(18));
  header.hops = from.octet(19);
  header.source = peer_id{from.big<std::int32_t>(20)};
  header.destination = peer_id{from.big<std::int32_t>(24)};
  header.port = from.big<std::uint16_t>(28);
  header.length = from.big<std::uint16_t>(30);
  header.seqlen = from.big<std::uint16_t>(32);
  header.seqid = from.big<std::uint16_t>(34);
  header.seqnum = from.big<std::uint16_t>(36);
  if (from.big<std::uint32_t>(0) != sync_word || header.id < 0 || header.ack_id < 0)
    return errc::bad_value;
  if (header.length > data_max)
    return errc::too_long;
  return header;
}

bool is_legal(const package_header& header) {
  if (header.type > package_type::direct || header.port >= port::count ||
      header.source.value <= 0 || header.id == 0 || header.hops == 0)
    return false;
  if (header.type == package_type::direct && header.destination.value <= 0)
    return false;
  if (header.seqlen == 0)
    return true;
  // Fragment fields are signed 16 bit; only direct messages may be long (peis-wire.md 7.1, 8.3).
  if (header.type != package_type::direct || header.seqlen > fragments_max ||
      header.seqnum >= header.seqlen)
    return false;
  const bool last = header.seqnum + 1 == header.seqlen;
  return last ? header.length > 0 : header.length == data_max;
}

} // namespace rubicon::peis
