// What a file may say about a mote's transducers and actuators.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/time.hpp"

namespace rubicon::mote {

/// Always the same value.
struct constant_model {
  double value = 0;
};

/// mean + amplitude * sin(2 pi (t / period + phase)).
struct sine_model {
  double mean = 0;
  double amplitude = 0;
  duration period = 24h;
  double phase_turns = 0; ///< 0.25 starts at the crest
};

/// Straight lines between (time, value) points, constant before the first and after the last.
struct points_model {
  std::vector<std::pair<duration, double>> points; ///< times strictly increasing, at least one
};

using transducer_model = std::variant<constant_model, sine_model, points_model>;

/// The kinds of transducer a descriptor can name; the number is the bit in its mask (DIS-09).
enum class quantity : std::uint8_t {
  temperature = 0,
  humidity = 1,
  light = 2,
  voltage = 3,
  presence = 4,
  acceleration = 5,
  magnetism = 6,
  sound = 7,
};

/// One transducer. A reading is round(value / resolution), as a signed 16-bit count.
struct transducer_config {
  quantity kind = quantity::temperature;
  transducer_model model;
  double noise = 0;        ///< standard deviation of Gaussian noise, in the value's own unit
  double resolution = 0.1; ///< value of one count, > 0
};

/// The kinds of actuator a descriptor can name; the number is the bit in its mask (DIS-09).
enum class actuator_kind : std::uint8_t {
  relay = 0,  ///< 0 off, 1 on
  dimmer = 1, ///< 0..255
};

struct actuator_config {
  std::string name; ///< unique on the mote
  actuator_kind kind = actuator_kind::relay;
  std::uint8_t initial = 0;
};

} // namespace rubicon::mote
