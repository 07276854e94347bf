#include "peis/udp/udp_datagram.hpp"

#include <algorithm>
#include <cassert>

#include "core/codec.hpp"
#include "core/serial_number.hpp"

namespace rubicon::peis {

namespace {

constexpr std::uint32_t sync = 0x52425531; // RBU1
constexpr std::uint8_t segment_kind = 6;

/// Field by field at its place: a hundred thousand of them leave a second.
template <class T>
std::uint8_t* put(std::uint8_t* to, T value) {
  for (std::size_t i = sizeof(T); i-- > 0;)
    *to++ = static_cast<std::uint8_t>(value >> (8 * i));
  return to;
}

} // namespace

std::string to_string(const udp_address& x) {
  auto text = std::to_string(x.ip[0]);
  for (std::size_t i = 1; i < x.ip.size(); ++i)
    text += '.' + std::to_string(x.ip[i]);
  return text + ':' + std::to_string(x.port);
}

std::uint64_t widened(std::uint32_t x, std::uint64_t near) {
  const auto whole = unwrapped(x, static_cast<std::int64_t>(near));
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, whole));
}

bytes encode(const udp_handshake& x) {
  return byte_writer()
      .big(sync)
      .octet(static_cast<std::uint8_t>(x.kind))
      .zeros(1)
      .big(x.room)
      .big(x.token.value)
      .big(x.cookie)
      .finish();
}

void encode(const udp_segment& x, bytes& out) {
  assert(x.content.size() <= udp_content_max);
  std::array<std::uint8_t, udp_segment_header> head{};
  auto* to = put(head.data(), sync);
  *to++ = segment_kind;
  *to++ = 0;
  to = put(to, x.room);
  to = put(to, x.token.value);
  to = put(to, x.sequence);
  to = put(to, x.expected);
  to = put(to, x.number);
  to = put(to, x.newest);
  to = put(to, x.count);
  put(to, x.credit);
  out.insert(out.end(), head.begin(), head.end());
  out.insert(out.end(), x.content.begin(), x.content.end());
}

result<udp_datagram> decode_udp_datagram(byte_view octets) {
  if (octets.size() < udp_handshake_size)
    return errc::truncated;
  if (octets.size() > udp_datagram_max)
    return errc::too_long;
  byte_reader from(octets);
  const auto word = from.big<std::uint32_t>();
  const auto kind = from.octet();
  from.skip(1);
  const auto room = from.big<std::uint16_t>();
  const udp_token token{from.big<std::uint64_t>()};
  if (word != sync || kind == 0 || kind > segment_kind)
    return errc::bad_value;
  if (kind != segment_kind) {
    if (octets.size() != udp_handshake_size)
      return errc::too_long;
    return udp_datagram(udp_handshake{static_cast<udp_handshake::step>(kind), room, token,
                                      from.big<std::uint64_t>()});
  }
  if (octets.size() < udp_segment_header)
    return errc::truncated;
  udp_segment x;
  x.room = room;
  x.token = token;
  x.sequence = from.big<std::uint64_t>();
  x.expected = from.big<std::uint64_t>();
  x.number = from.big<std::uint32_t>();
  x.newest = from.big<std::uint32_t>();
  x.count = from.big<std::uint32_t>();
  x.credit = from.big<std::uint16_t>();
  from.skip(2);
  x.content = from.rest();
  if (x.number != 0 && x.content.empty())
    return errc::bad_value;
  return udp_datagram(x);
}

} // namespace rubicon::peis
