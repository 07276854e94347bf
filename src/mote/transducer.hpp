// Transducer models: what a mote would measure at a given time (STR-21).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/random.hpp"
#include "core/time.hpp"
#include "mote/transducer_config.hpp"

namespace rubicon::mote {

/// The model's value at `now`, noise included, in its own unit.
[[nodiscard]] double value_of(const transducer_config& config, instant now, random_stream& dice);

/// The reading a mote sends: round(value / resolution), kept within a signed 16-bit count.
[[nodiscard]] std::int16_t sample(const transducer_config& config, instant now,
                                  random_stream& dice);

[[nodiscard]] std::string to_string(quantity x);
[[nodiscard]] std::string_view to_string(actuator_kind x);

} // namespace rubicon::mote
