// What a file may say about motes that run plain programs of TinyOS.
#pragma once

#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/bytes.hpp"

namespace rubicon::gateway {

/// Addresses of motes, both ends included.
struct address_range {
  std::uint16_t first = 1;
  std::uint16_t last = mote_id_max;

  [[nodiscard]] bool has(mote_id x) const { return first <= x.value && x.value <= last; }
};

/// How the octets of an input become the payload of a packet. All but the first take 2 octets, a
/// number in network byte order.
enum class plain_form : std::uint8_t {
  octets,       ///< as they are
  count,        ///< of RadioCountToLeds: the number
  blink,        ///< of BlinkToRadio: an address, which no program reads, and the number
  oscilloscope, ///< of Oscilloscope: the number is its interval in ms
  mviz,         ///< of MViz, whose packets are shorter: the same
};

/// Packets of one AM type, or with some octets, from some motes are messages of devices; and what
/// is written to one of their inputs is a packet to them.
struct plain_rule {
  std::optional<std::uint8_t> am_type = {}; ///< nothing: frames that are no packets of TinyOS
  std::uint16_t first = 1;                  ///< addresses of the motes: from this one
  std::uint16_t last = mote_id_max;         ///< to this one
  std::uint32_t type = 0;                   ///< as which they are devices
  std::uint8_t channel = 1;                 ///< of their output that has the payload
  std::uint8_t input = 0;                   ///< channel of their input; 0: they have none
  std::uint8_t input_am_type = 0;           ///< of the packets that it becomes
  plain_form input_form = plain_form::octets;
  /// Where in the payload a mote's address is, 2 octets in network byte order; nothing: it is the
  /// packet's source, which programs at a serial line leave at 0 (docs/tinyos.md 1.2).
  std::optional<std::uint8_t> id_offset = {};
  bytes pattern = {};              ///< octets that the payload must have
  std::uint8_t pattern_offset = 0; ///< of the first of them in it
};

} // namespace rubicon::gateway
