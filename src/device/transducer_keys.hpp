// The keys of what a file may say about transducers, by how their values behave.
#pragma once

#include "core/describe/keys.hpp"
#include "device/transducer_config.hpp"

namespace rubicon::device {

inline auto keys_of(const constant_model*) {
  return keys::of(keys::required("value", &constant_model::value, keys::real{}, "always this"));
}

inline auto keys_of(const sine_model*) {
  return keys::of(
      keys::required("mean", &sine_model::mean, keys::real{}, "in the middle"),
      keys::required("amplitude", &sine_model::amplitude, keys::real{}, "from the mean to a crest"),
      keys::optional("period", &sine_model::period, keys::time_span{1ms}, "from crest to crest"),
      keys::optional("phase_turns", &sine_model::phase_turns, keys::real{-1, 1},
                     "`0.25` starts at the crest"));
}

inline auto keys_of(const points_model*) {
  return keys::of(keys::required("points", &points_model::points, keys::time_points{},
                                 "times since the start, in increasing order, and values"));
}

inline auto keys_of(const random_walk_model*) {
  return keys::of(
      keys::required("start", &random_walk_model::start, keys::real{},
                     {"value at the start", "", "`min` to `max`"}),
      keys::required("step", &random_walk_model::step, keys::real{0, 1e9},
                     "standard deviation of the change within a second; within t seconds it is "
                     "sqrt(t) times this"),
      keys::required("min", &random_walk_model::min, keys::real{}, "lower limit"),
      keys::required("max", &random_walk_model::max, keys::real{},
                     {"upper limit", "", "number, more than `min`"}));
}

inline auto keys_of(const field_source*) {
  return keys::of(
      keys::required("position_m", &field_source::place, keys::place{}, "where it is"),
      keys::required("strength", &field_source::strength, keys::real{},
                     "value that it adds at its own position"),
      keys::optional("radius", &field_source::radius_m, keys::metres{0.01, 100'000},
                     "range, as defined by `falloff`"),
      keys::optional("falloff", &field_source::shape,
                     keys::word<falloff>{{{"inverse_square", falloff::inverse_square},
                                          {"gaussian", falloff::gaussian},
                                          {"linear", falloff::linear},
                                          {"disk", falloff::disk}}},
                     "share of the strength at the distance d: 1 / (1 + (d / r)^2), exp(-(d / "
                     "r)^2 / 2), 1 - d / r up to r, or all of it up to r"),
      keys::optional("schedule", &field_source::schedule, keys::time_points{},
                     {"factor of the strength, in straight lines as in [`model = "
                      "\"points\"`](#model--points)",
                      "always 1", "`[[\"0s\", 0], [\"1h\", 1]]`, at least 1"}),
      keys::optional("period", &field_source::period, keys::time_span{1ms},
                     {"the schedule begins again", "it does not repeat",
                      "time from 1 ms, not before the schedule's end"}));
}

inline auto keys_of(const trace_model*) {
  return keys::of(
      keys::optional(
          "mote", &trace_model::mote, keys::whole<std::uint32_t>{},
          {"mote whose readings are replayed; only with `mote_column`", "the mote's own id"}),
      keys::optional("repeat", &trace_model::repeats, keys::flag{},
                     "repeat from the start after the last reading of all motes, which lasts as "
                     "long as the one before it"),
      keys::optional("interpolation", &trace_model::straight,
                     keys::word<bool>{{{"hold", false}, {"linear", true}}},
                     "between two readings: the earlier one, or a straight line"),
      keys::optional("scale", &trace_model::scale, keys::real{-1e9, 1e9}, "factor of the values"),
      keys::optional("offset", &trace_model::offset, keys::real{-1e9, 1e9},
                     "added to the scaled value"));
}

inline auto keys_of(const transducer_config*) {
  return keys::of(keys::optional("noise", &transducer_config::noise, keys::real{0},
                                 "standard deviation of Gaussian noise, in the value's unit"),
                  keys::optional("resolution", &transducer_config::resolution,
                                 keys::real{1e-9, 1e9},
                                 "value of one count; the model must stay within 32767 counts"));
}

} // namespace rubicon::device
