#include "serial/frame.hpp"

#include <array>
#include <cassert>

namespace rubicon::serial {

namespace {

constexpr std::uint16_t polynomial = 0x1021;
constexpr std::size_t frame_octets_min = 4; // type, one octet, CRC

constexpr std::array<std::uint16_t, 256> make_crc_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned octet = 0; octet < table.size(); ++octet) {
    unsigned crc = octet << 8;
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc & 0x8000U) != 0 ? crc << 1 ^ polynomial : crc << 1;
    table[octet] = static_cast<std::uint16_t>(crc);
  }
  return table;
}

constexpr auto crc_table = make_crc_table();

void append_escaped(bytes& wire, byte_view octets) {
  for (const auto octet : octets) {
    if (octet == flag_octet || octet == escape_octet) {
      wire.push_back(escape_octet);
      wire.push_back(octet ^ escape_mask);
    } else {
      wire.push_back(octet);
    }
  }
}

} // namespace

std::uint16_t crc16(byte_view octets, std::uint16_t start) {
  unsigned crc = start;
  for (const auto octet : octets)
    crc = (crc << 8 & 0xffffU) ^ crc_table[crc >> 8 ^ octet];
  return static_cast<std::uint16_t>(crc);
}

bytes encode(const frame& x) {
  assert(x.type != frame_type::ack || x.packet.empty());
  bytes head{static_cast<std::uint8_t>(x.type)};
  if (has_sequence(x.type))
    head.push_back(x.sequence);
  const unsigned crc = crc16(x.packet, crc16(head));
  const std::array<std::uint8_t, 2> tail{static_cast<std::uint8_t>(crc & 0xffU),
                                         static_cast<std::uint8_t>(crc >> 8)};
  bytes wire;
  wire.reserve(x.packet.size() + 16);
  wire.push_back(flag_octet);
  append_escaped(wire, head);
  append_escaped(wire, x.packet);
  append_escaped(wire, tail);
  wire.push_back(flag_octet);
  return wire;
}

std::optional<frame> frame_decoder::on_octet(std::uint8_t octet) {
  if (octet == flag_octet)
    return on_flag();
  if (!in_frame_)
    return {};
  if (octet == escape_octet && !escaped_) {
    escaped_ = true;
    return {};
  }
  if (content_.size() == frame_octets_max) {
    ++counters_.too_long;
    lose_place();
    return {};
  }
  content_.push_back(escaped_ ? octet ^ escape_mask : octet);
  escaped_ = false;
  return {};
}

std::optional<frame> frame_decoder::on_flag() {
  if (escaped_) {
    ++counters_.aborted;
    lose_place();
    return {};
  }
  auto complete = in_frame_ && !content_.empty() ? parse(content_) : std::nullopt;
  in_frame_ = true;
  content_.clear();
  return complete;
}

std::optional<frame> frame_decoder::parse(byte_view content) {
  if (content.size() < frame_octets_min) {
    ++counters_.too_short;
    return {};
  }
  const auto covered = content.first(content.size() - 2);
  const auto tail = content.last(2);
  if (crc16(covered) != (tail[0] | tail[1] << 8)) {
    ++counters_.bad_crc;
    return {};
  }
  const auto type = static_cast<frame_type>(covered[0]);
  switch (type) {
  case frame_type::ack:
    if (covered.size() != 2) {
      ++counters_.malformed;
      return {};
    }
    [[fallthrough]];
  case frame_type::packet_with_ack:
    ++counters_.good;
    return frame{type, covered[1], to_bytes(covered.subspan(2))};
  case frame_type::packet:
  case frame_type::unknown:
    ++counters_.good;
    return frame{type, 0, to_bytes(covered.subspan(1))};
  }
  ++counters_.unknown_type;
  return {};
}

void frame_decoder::lose_place() {
  in_frame_ = false;
  escaped_ = false;
  content_.clear();
}

} // namespace rubicon::serial
