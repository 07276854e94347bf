// What a peer is equipped with: an XML document, and the bitmask that motes store and exchange
// (D1.1 3.4.2, SMP-11).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "core/address.hpp"

namespace rubicon::smepp {

/// Bit i of a bitmask stands for the i-th name.
inline constexpr std::array<std::string_view, 16> transducer_names{
    "temperature", "humidity", "light",   "pressure", "accelerometer", "magnetometer",
    "microphone",  "presence", "voltage", "rssi",     "switch",        "sounder",
    "led",         "relay",    "motor",   "camera"};

/// Transducers of a peer, bit by bit; bits beyond the names are none.
using transducer_mask = std::uint32_t;
inline constexpr transducer_mask all_transducers = (1U << transducer_names.size()) - 1;

struct peer_description {
  mote_id peer;
  transducer_mask transducers = 0;

  friend bool operator==(const peer_description&, const peer_description&) = default;
};

/// Where an XML text is not a peer's description; line and column count from 1.
struct xml_problem {
  std::size_t line = 1;
  std::size_t column = 1;
  std::string message;

  friend bool operator==(const xml_problem&, const xml_problem&) = default;
};

/// `line:column: message`
[[nodiscard]] std::string to_string(const xml_problem& x);

/// `<peer id="7"><transducer type="light"/></peer>`: an id of a mote, each transducer once. White
/// space, comments and an XML declaration may stand where XML 1.0 has them; nothing else may.
[[nodiscard]] std::variant<peer_description, xml_problem>
parse_peer_description(std::string_view xml);

/// One line for each transducer, in the order of the names. @pre only bits with names are set
[[nodiscard]] std::string to_xml(const peer_description& x);

} // namespace rubicon::smepp
