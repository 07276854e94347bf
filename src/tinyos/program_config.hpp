// What a file may say about a plain program of TinyOS on a simulated mote.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/time.hpp"
#include "device/transducer_config.hpp"

namespace rubicon::tinyos {

/// Programs of TinyOS's distribution that join nothing and whose packets everybody knows.
enum class program_kind : std::uint8_t {
  oscilloscope, ///< readings of one transducer, ten a packet
  blink,        ///< BlinkToRadio: address and count
  count,        ///< RadioCountToLeds: count
};

[[nodiscard]] constexpr std::string_view to_string(program_kind x) {
  return x == program_kind::oscilloscope ? "oscilloscope"
         : x == program_kind::blink      ? "blink"
                                         : "count";
}

struct program_config {
  program_kind kind = program_kind::oscilloscope;
  duration every = 250ms; ///< from one reading, or of the others packet, to the next
  std::optional<device::quantity> transducer{}; ///< of an oscilloscope
};

} // namespace rubicon::tinyos
