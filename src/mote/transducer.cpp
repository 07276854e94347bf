#include "mote/transducer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/math.hpp"

namespace rubicon::mote {

namespace {

struct evaluator {
  instant now;

  double operator()(const constant_model& x) const { return x.value; }

  double operator()(const sine_model& x) const {
    // The phase within one period is exact in integers, so that long runs lose no precision.
    const auto phase = now.time_since_epoch() % x.period;
    const auto turns = static_cast<double>(phase.count()) / static_cast<double>(x.period.count());
    return x.mean + x.amplitude * math::sine_of_turns(turns + x.phase_turns);
  }

  double operator()(const points_model& x) const {
    assert(!x.points.empty());
    const auto t = now.time_since_epoch();
    const auto next = std::upper_bound(x.points.begin(), x.points.end(), t,
                                       [](duration a, const auto& b) { return a < b.first; });
    if (next == x.points.begin())
      return next->second;
    const auto& [t0, v0] = *std::prev(next);
    if (next == x.points.end())
      return v0;
    const auto& [t1, v1] = *next;
    const auto share =
        static_cast<double>((t - t0).count()) / static_cast<double>((t1 - t0).count());
    return v0 + (v1 - v0) * share;
  }
};

} // namespace

double value_of(const transducer_config& config, instant now, random_stream& dice) {
  const auto value = std::visit(evaluator{now}, config.model);
  return config.noise > 0 ? value + config.noise * dice.normal() : value;
}

std::int16_t sample(const transducer_config& config, instant now, random_stream& dice) {
  using limits = std::numeric_limits<std::int16_t>;
  const auto count = std::floor(value_of(config, now, dice) / config.resolution + 0.5);
  return static_cast<std::int16_t>(std::clamp(count, double{limits::min()}, double{limits::max()}));
}

std::string to_string(quantity x) {
  switch (x) {
  case quantity::temperature:
    return "temperature";
  case quantity::humidity:
    return "humidity";
  case quantity::light:
    return "light";
  case quantity::voltage:
    return "voltage";
  case quantity::presence:
    return "presence";
  case quantity::acceleration:
    return "acceleration";
  case quantity::magnetism:
    return "magnetism";
  case quantity::sound:
    return "sound";
  }
  return "unknown";
}

std::string_view to_string(actuator_kind x) {
  switch (x) {
  case actuator_kind::relay:
    return "relay";
  case actuator_kind::dimmer:
    return "dimmer";
  }
  return "unknown";
}

} // namespace rubicon::mote
