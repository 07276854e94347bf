// What a file may say about a mote's transducers and actuators.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "device/trace_table.hpp"

namespace rubicon::device {

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
  time_series points; ///< at least one
};

/// A Brownian motion that its bounds throw back: a function of time and of the reader's seed, so
/// that it neither notices who reads it nor starts again with the mote.
struct random_walk_model {
  double start = 0; ///< min..max
  double step = 0;  ///< standard deviation of the change within a second, >= 0
  double min = 0;
  double max = 0; ///< > min
};

/// How what a source adds becomes less with the distance d from it.
enum class falloff : std::uint8_t {
  inverse_square, ///< 1 / (1 + (d / radius)^2)
  gaussian,       ///< exp(-(d / radius)^2 / 2)
  linear,         ///< 1 - d / radius, and nothing beyond the radius
  disk,           ///< 1 up to the radius, and nothing beyond
};

struct field_source {
  position place;
  double strength = 0; ///< what it adds at its own place
  double radius_m = 1; ///< > 0
  falloff shape = falloff::inverse_square;
  time_series schedule; ///< factor of the strength, as in points_model; empty: always 1
  duration period{};    ///< of the schedule; 0: it does not repeat
};

/// A function of place and time: base + gradient . place + what the sources add.
struct field_model {
  double base = 0;
  std::array<double, 3> gradient_per_m{};
  std::vector<field_source> sources;
};

/// Replays a trace: before its first reading it gives the first, after its last one the last.
struct trace_model {
  std::shared_ptr<const trace_table> table; ///< not nullptr
  std::optional<std::uint32_t> mote;        ///< in the table; set before the model is used
  bool repeats = false;                     ///< begins again after each turn of the table
  bool straight = false;                    ///< straight lines between readings instead of steps
  double scale = 1;
  double offset = 0; ///< added to the scaled value
};

using transducer_model = std::variant<constant_model, sine_model, points_model, random_walk_model,
                                      field_model, trace_model>;

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
  signal = 8, ///< not a transducer: how strongly the mote's parent is received, in dBm. Every mote
              ///< has it, none describes it
};

/// Own quantities of a file have the numbers from this one on, one behind the other; the mask of a
/// descriptor has room for so many in all.
inline constexpr std::size_t first_own_quantity = 9;
inline constexpr std::size_t quantities_max = 32;

/// One transducer. A reading is round(value / resolution), as a signed 16-bit count.
struct transducer_config {
  quantity kind = quantity::temperature;
  transducer_model model;
  double noise = 0;        ///< standard deviation of Gaussian noise, in the value's own unit
  double resolution = 0.1; ///< value of one count, > 0
  duration elapsed{};      ///< since the start of the run, when this process began
};

/// The kinds of actuator a descriptor can name; the number is the bit in its mask (DIS-09).
enum class actuator_kind : std::uint8_t {
  relay = 0,  ///< 0 off, 1 on
  dimmer = 1, ///< 0..255
  level = 2,  ///< 0..255, where it moves to: a blind, a valve
};

struct actuator_config {
  std::string name; ///< unique on the mote
  actuator_kind kind = actuator_kind::relay;
  std::uint8_t initial = 0;
  duration travel{}; ///< from 0 to 255, at constant speed; 0: at once, as relays always
};

} // namespace rubicon::device
