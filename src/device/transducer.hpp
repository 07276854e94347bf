// Transducer models: what a mote would measure at a given time and place (STR-21).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/address.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "device/transducer_config.hpp"

namespace rubicon::device {

/// Who reads a transducer.
struct reader {
  position place;
  std::uint64_t seed = 0; ///< of random walks: the same in all lives of a mote
};

/// The model's value at `now` of this process, noise included, in its own unit. Draws from `rng`
/// for noise only.
[[nodiscard]] double value_of(const transducer_config& config, instant now, random_stream& rng,
                              const reader& who = {});

/// The reading a mote sends: round(value / resolution), clamped to a signed 16-bit count.
[[nodiscard]] std::int16_t sample(const transducer_config& config, instant now, random_stream& rng,
                                  const reader& who = {});

[[nodiscard]] std::string to_string(quantity x);
[[nodiscard]] std::string_view to_string(actuator_kind x);

} // namespace rubicon::device
