#include "device/transducer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/hash.hpp"
#include "core/numbers/math.hpp"
#include "device/random_walk.hpp"

namespace rubicon::device {

namespace {

/// The reading at or before `t`; the first if there is none.
time_series::const_iterator latest(const time_series& series, duration t) {
  assert(!series.empty());
  const auto next = std::upper_bound(series.begin(), series.end(), t,
                                     [](duration a, const auto& b) { return a < b.first; });
  return next == series.begin() ? next : std::prev(next);
}

/// On the straight lines between the values; constant before the first and after the last.
double between(const time_series& series, duration t) {
  const auto at = latest(series, t);
  const auto next = std::next(at);
  if (t <= at->first || next == series.end())
    return at->second;
  const auto share = static_cast<double>((t - at->first).count()) /
                     static_cast<double>((next->first - at->first).count());
  return at->second + (next->second - at->second) * share;
}

double distance_m(const position& a, const position& b) {
  return math::length(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

/// @param d distance in radii
double share_at(falloff shape, double d) {
  switch (shape) {
  case falloff::inverse_square:
    return 1 / (1 + d * d);
  case falloff::gaussian:
    return math::exp(-d * d / 2);
  case falloff::linear:
    return std::max(0.0, 1 - d);
  case falloff::disk:
    return d <= 1 ? 1 : 0;
  }
  return 0;
}

double added_by(const field_source& x, duration t, const position& place) {
  const auto share = share_at(x.shape, distance_m(x.place, place) / x.radius_m);
  if (x.schedule.empty())
    return x.strength * share;
  return x.strength * share * between(x.schedule, x.period > 0s ? t % x.period : t);
}

struct evaluator {
  duration t; ///< since the start of the run
  quantity kind;
  const reader& who;

  double operator()(const constant_model& x) const { return x.value; }

  double operator()(const sine_model& x) const {
    // The phase within one period is exact in integers, so that long runs lose no precision.
    const auto phase = t % x.period;
    const auto turns = static_cast<double>(phase.count()) / static_cast<double>(x.period.count());
    return x.mean + x.amplitude * math::sine_of_turns(turns + x.phase_turns);
  }

  double operator()(const points_model& x) const { return between(x.points, t); }

  double operator()(const random_walk_model& x) const {
    const auto seed = fold64(who.seed).add(static_cast<std::uint64_t>(kind)).value();
    return reflected(x.start + x.step * brownian(seed, t), x.min, x.max);
  }

  double operator()(const field_model& x) const {
    const auto& [along_x, along_y, along_z] = x.gradient_per_m;
    auto sum = x.base + along_x * who.place.x_m + along_y * who.place.y_m + along_z * who.place.z_m;
    for (const auto& source : x.sources)
      sum += added_by(source, t, who.place);
    return sum;
  }

  double operator()(const trace_model& x) const {
    assert(x.table != nullptr && x.mote.has_value());
    const auto& series = x.table->of_mote.at(*x.mote);
    const auto at = x.repeats && x.table->turn > 0s ? t % x.table->turn : t;
    return x.offset + x.scale * (x.straight ? between(series, at) : latest(series, at)->second);
  }
};

} // namespace

double value_of(const transducer_config& config, instant now, random_stream& rng,
                const reader& who) {
  const auto value = std::visit(
      evaluator{now.time_since_epoch() + config.elapsed, config.kind, who}, config.model);
  return config.noise > 0 ? value + config.noise * rng.normal() : value;
}

std::int16_t sample(const transducer_config& config, instant now, random_stream& rng,
                    const reader& who) {
  using limits = std::numeric_limits<std::int16_t>;
  const auto count = std::floor(value_of(config, now, rng, who) / config.resolution + 0.5);
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
  case quantity::signal:
    return "signal";
  }
  return "unknown";
}

std::string_view to_string(actuator_kind x) {
  switch (x) {
  case actuator_kind::relay:
    return "relay";
  case actuator_kind::dimmer:
    return "dimmer";
  case actuator_kind::level:
    return "level";
  }
  return "unknown";
}

} // namespace rubicon::device
