#include "radio/frame.hpp"

#include <array>
#include <cassert>

#include "core/codec.hpp"

namespace rubicon::radio {

namespace {

// FCF of tinyos.md 4.1: short addresses, one PAN id; with and without ack request.
constexpr std::uint16_t fcf_data = 0x8841;
constexpr std::uint16_t fcf_data_acked = 0x8861;
constexpr std::uint16_t fcf_ack = 0x0002;
constexpr std::uint8_t network_octet = 0x3f; ///< "not a LoWPAN frame"
constexpr std::size_t fcs_size = 2;

// CRC-16/KERMIT, one table entry an octet.
constexpr auto fcs_table = [] {
  std::array<std::uint16_t, 256> table{};
  for (unsigned i = 0; i < table.size(); ++i) {
    unsigned crc = i;
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc & 1) != 0 ? (crc >> 1) ^ 0x8408U : crc >> 1;
    table[i] = static_cast<std::uint16_t>(crc);
  }
  return table;
}();

result<frame> decode_ack(byte_view content) {
  if (content.size() > ack_size - fcs_size)
    return errc::too_long;
  frame x;
  x.type = frame_type::ack;
  x.dsn = content.back();
  return x;
}

result<frame> decode_data(byte_reader reader, bool ack_request) {
  frame x;
  x.ack_request = ack_request;
  x.dsn = reader.octet();
  x.pan = reader.little<std::uint16_t>();
  x.destination = mote_id{reader.little<std::uint16_t>()};
  x.source = mote_id{reader.little<std::uint16_t>()};
  const auto network = reader.octet();
  x.am_type = reader.octet();
  x.payload = reader.rest();
  if (!reader.ok())
    return errc::truncated;
  if (network != network_octet)
    return errc::unsupported;
  return x;
}

} // namespace

std::uint16_t fcs(byte_view octets) {
  std::uint16_t crc = 0;
  for (const auto octet : octets)
    crc = static_cast<std::uint16_t>((crc >> 8) ^ fcs_table[(crc ^ octet) & 0xff]);
  return crc;
}

bytes encode(const frame& x) {
  byte_writer writer;
  if (x.type == frame_type::ack) {
    writer.little(fcf_ack).octet(x.dsn);
  } else {
    assert(x.payload.size() <= payload_max);
    writer.little(x.ack_request ? fcf_data_acked : fcf_data)
        .octet(x.dsn)
        .little(x.pan)
        .little(x.destination.value)
        .little(x.source.value)
        .octet(network_octet)
        .octet(x.am_type)
        .append(x.payload);
  }
  writer.little(fcs(writer.view()));
  return writer.finish();
}

result<frame> decode(byte_view psdu) {
  if (psdu.size() < ack_size)
    return errc::truncated;
  if (psdu.size() > psdu_max)
    return errc::too_long;
  const auto content = psdu.first(psdu.size() - fcs_size);
  if (byte_reader(psdu.last(fcs_size)).little<std::uint16_t>() != fcs(content))
    return errc::bad_checksum;
  byte_reader reader(content);
  switch (reader.little<std::uint16_t>()) {
  case fcf_ack:
    return decode_ack(content);
  case fcf_data:
    return decode_data(reader, false);
  case fcf_data_acked:
    return decode_data(reader, true);
  default:
    return errc::unsupported;
  }
}

} // namespace rubicon::radio
