#include "radio/frame.hpp"

#include <array>
#include <cassert>

#include "core/codec.hpp"

namespace rubicon::radio {

namespace {

// FCF of docs/tinyos.md 4.1: short addresses, one PAN id; with and without ack request.
constexpr std::uint16_t fcf_data = 0x8841;
constexpr std::uint16_t fcf_data_acked = 0x8861;
constexpr std::uint16_t fcf_ack = 0x0002;
constexpr std::uint8_t network_octet = 0x3f; ///< "not a LoWPAN frame"
constexpr std::size_t fcs_size = 2;

constexpr std::size_t fcs_stride = 8; ///< octets taken in one step

// CRC-16/KERMIT: what an octet makes of the checksum, with so many zero octets behind it.
constexpr auto fcs_tables = [] {
  std::array<std::array<std::uint16_t, 256>, fcs_stride> tables{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned crc = i;
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc & 1) != 0 ? (crc >> 1) ^ 0x8408U : crc >> 1;
    tables[0][i] = static_cast<std::uint16_t>(crc);
  }
  for (std::size_t zeros = 1; zeros < fcs_stride; ++zeros) {
    for (unsigned i = 0; i < 256; ++i) {
      const auto before = tables[zeros - 1][i];
      tables[zeros][i] = static_cast<std::uint16_t>((before >> 8) ^ tables[0][before & 0xff]);
    }
  }
  return tables;
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
  constexpr const auto& after = fcs_tables; // by the octets that follow
  unsigned crc = 0;
  for (; octets.size() >= fcs_stride; octets = octets.subspan(fcs_stride)) {
    const auto* const x = octets.data();
    crc = after[7][(crc ^ x[0]) & 0xff] ^ after[6][(crc >> 8) ^ x[1]] ^ after[5][x[2]] ^
          after[4][x[3]] ^ after[3][x[4]] ^ after[2][x[5]] ^ after[1][x[6]] ^ after[0][x[7]];
  }
  for (const auto octet : octets)
    crc = (crc >> 8) ^ fcs_tables[0][(crc ^ octet) & 0xff];
  return static_cast<std::uint16_t>(crc);
}

bytes encode(const frame& x) {
  byte_writer writer(x.type == frame_type::ack ? ack_size : overhead + x.payload.size());
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
