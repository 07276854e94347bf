#include "synaptic/message.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>

#include "core/codec.hpp"

namespace rubicon::synaptic {

namespace {

static_assert(std::numeric_limits<float>::is_iec559 && sizeof(float) == value_size);

struct writer {
  byte_writer& to;

  void operator()(const open_message& x) const { to.octet(0x11).octet(x.size).octet(x.divisor); }
  void operator()(const open_ack_message&) const { to.octet(0x12); }
  void operator()(const open_nak_message&) const { to.octet(0x13); }
  void operator()(const vector_message& x) const {
    to.octet(0x14).big(x.tick).octet(x.first);
    for (const auto value : x.values)
      to.big(std::bit_cast<std::uint32_t>(value));
  }
  void operator()(const stop_message& x) const { to.octet(0x15).big(x.tick); }
  void operator()(const stop_ack_message& x) const { to.octet(0x16).big(x.tick); }
};

std::vector<float> read_values(byte_reader& from) {
  std::vector<float> values;
  do
    values.push_back(std::bit_cast<float>(from.big<std::uint32_t>()));
  while (from.remaining() > 0 && from.ok());
  return values;
}

/// Of a SYN_VECTOR of so many octets.
std::size_t values_in(std::size_t packet_max) {
  assert(packet_max >= vector_header_size + value_size);
  return (packet_max - vector_header_size) / value_size;
}

/// @returns whether the kind is known
bool read_fields(std::uint8_t kind, byte_reader& from, message& x) {
  switch (kind) {
  case 0x11: {
    const auto size = from.octet();
    x.emplace<open_message>(open_message{size, from.octet()});
    return true;
  }
  case 0x12:
    x.emplace<open_ack_message>();
    return true;
  case 0x13:
    x.emplace<open_nak_message>();
    return true;
  case 0x14: {
    const auto tick = from.big<std::uint32_t>();
    const auto first = from.octet();
    x.emplace<vector_message>(vector_message{tick, first, read_values(from)});
    return true;
  }
  case 0x15:
    x.emplace<stop_message>(stop_message{from.big<std::uint32_t>()});
    return true;
  case 0x16:
    x.emplace<stop_ack_message>(stop_ack_message{from.big<std::uint32_t>()});
    return true;
  default:
    return false;
  }
}

} // namespace

bytes encode(const message& x) {
  byte_writer to;
  std::visit(writer{to}, x);
  return to.finish();
}

std::vector<bytes> encode_vector(std::uint32_t tick, std::span<const float> values,
                                 std::size_t packet_max) {
  const auto part_max = values_in(packet_max);
  std::vector<bytes> packets;
  for (std::size_t first = 0; first < values.size(); first += part_max) {
    const auto part = values.subspan(first, std::min(part_max, values.size() - first));
    packets.push_back(encode(vector_message{tick, static_cast<std::uint8_t>(first),
                                            std::vector<float>(part.begin(), part.end())}));
  }
  return packets;
}

std::vector<std::size_t> vector_packets(std::size_t elements, std::size_t packet_max) {
  const auto part_max = values_in(packet_max);
  std::vector<std::size_t> octets;
  for (std::size_t first = 0; first < elements; first += part_max)
    octets.push_back(vector_header_size + std::min(part_max, elements - first) * value_size);
  return octets;
}

result<message> decode_message(byte_view octets) {
  byte_reader from(octets);
  const auto kind = from.octet();
  message x;
  if (from.ok() && !read_fields(kind, from, x))
    return errc::unsupported;
  if (!from.ok())
    return errc::truncated;
  if (from.remaining() > 0)
    return errc::too_long;
  const auto* open = std::get_if<open_message>(&x);
  if (open != nullptr && (open->size == 0 || open->divisor == 0))
    return errc::bad_value;
  return x;
}

} // namespace rubicon::synaptic
