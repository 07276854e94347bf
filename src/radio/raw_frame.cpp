#include "radio/raw_frame.hpp"

#include "core/codec.hpp"

namespace rubicon::radio {

namespace {

// Bits of the frame control field, IEEE 802.15.4-2006 figure 42 and 802.15.4-2015 figure 7-2.
constexpr unsigned fcf_ack_request = 1U << 5U;
constexpr unsigned one_pan = 1U << 6U;
constexpr unsigned no_sequence_number = 1U << 8U;
constexpr unsigned destination_shift = 10;
constexpr unsigned version_shift = 12;
constexpr unsigned source_shift = 14;
constexpr unsigned version_2015 = 2;
constexpr std::size_t pan_octets = 2;
constexpr std::size_t long_octets = 8;

enum class address : std::uint8_t { none = 0, reserved = 1, brief = 2, extended = 3 };

address mode_at(unsigned fcf, unsigned shift) {
  return static_cast<address>(fcf >> shift & 3U);
}

/// Whether the PAN of the destination, and that of the source, are in the frame.
struct pans {
  bool destination = false;
  bool source = false;
};

pans pans_of(unsigned fcf, address to, address from) {
  const bool is_one = (fcf & one_pan) != 0;
  const bool has_to = to != address::none;
  const bool has_from = from != address::none;
  if ((fcf >> version_shift & 3U) < version_2015)
    return {has_to, has_from && !(is_one && has_to)};
  if (has_to && has_from)
    return to == address::extended && from == address::extended ? pans{!is_one, false}
                                                                : pans{true, !is_one};
  if (has_to)
    return {!is_one, false};
  return {!has_from && is_one, has_from && !is_one};
}

mote_id read_address(byte_reader& in, address mode) {
  if (mode == address::none || mode == address::reserved)
    return broadcast_mote;
  const mote_id found{in.little<std::uint16_t>()};
  if (mode == address::extended)
    in.skip(long_octets - sizeof(std::uint16_t));
  return found;
}

} // namespace

frame read_header(byte_view octets, std::uint16_t pan) {
  byte_reader in(octets);
  const unsigned fcf = in.little<std::uint16_t>();
  const bool is_2015 = (fcf >> version_shift & 3U) >= version_2015;
  frame x;
  x.pan = pan;
  if (!is_2015 || (fcf & no_sequence_number) == 0)
    x.dsn = in.octet();
  const auto to = mode_at(fcf, destination_shift);
  const auto from = mode_at(fcf, source_shift);
  const auto has_pan = pans_of(fcf, to, from);
  if (has_pan.destination)
    in.skip(pan_octets);
  x.destination = read_address(in, to);
  if (has_pan.source)
    in.skip(pan_octets);
  const auto source = read_address(in, from);
  if (!in.ok()) {
    x.destination = broadcast_mote;
    return x;
  }
  x.source = source;
  x.ack_request = (fcf & fcf_ack_request) != 0 && x.destination != broadcast_mote;
  return x;
}

bytes with_fcs(byte_view octets) {
  byte_writer out(octets.size() + sizeof(std::uint16_t));
  out.append(octets).little(fcs(octets));
  return out.finish();
}

} // namespace rubicon::radio
