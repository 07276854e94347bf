#include "config/plan/counts.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "proxy/classes/layout.hpp"

namespace rubicon::config {

namespace {

using value_range = std::pair<double, double>;

value_range range_of(const device::time_series& series) {
  const auto [least, most] =
      std::ranges::minmax_element(series, {}, [](const auto& x) { return x.second; });
  return {least->second, most->second};
}

/// What a source adds at least and at most; at its own place, and far away.
value_range range_of(const device::field_source& x) {
  const auto [least, most] = x.schedule.empty() ? value_range(1, 1) : range_of(x.schedule);
  const auto [a, b] = std::minmax({x.strength * least, x.strength * most});
  return {std::min(a, 0.0), std::max(b, 0.0)};
}

struct model_range {
  const mote_description& mote;

  std::optional<value_range> operator()(const device::constant_model& x) const {
    return value_range(x.value, x.value);
  }
  std::optional<value_range> operator()(const device::sine_model& x) const {
    const auto half = std::abs(x.amplitude);
    return value_range(x.mean - half, x.mean + half);
  }
  std::optional<value_range> operator()(const device::points_model& x) const {
    return range_of(x.points);
  }
  std::optional<value_range> operator()(const device::random_walk_model& x) const {
    return value_range(x.min, x.max);
  }
  std::optional<value_range> operator()(const device::field_model& x) const {
    const auto& [along_x, along_y, along_z] = x.gradient_per_m;
    if (along_x != 0 || along_y != 0 || along_z != 0)
      return std::nullopt; // motes are carried about
    value_range sum(x.base, x.base);
    for (const auto& each : x.sources) {
      const auto [least, most] = range_of(each);
      sum.first += least;
      sum.second += most;
    }
    return sum;
  }
  std::optional<value_range> operator()(const device::trace_model& x) const {
    const auto series = x.table->of_mote.find(x.mote.value_or(mote.id.value));
    if (series == x.table->of_mote.end())
      return std::nullopt;
    const auto [least, most] = range_of(series->second);
    const auto [a, b] = std::minmax({x.offset + x.scale * least, x.offset + x.scale * most});
    return value_range(a, b);
  }
};

std::optional<count_range> counts_of(const mote_description& mote, device::quantity kind) {
  constexpr double deviations = 6;
  constexpr double count_min = -32768;
  constexpr double count_max = 32767;
  if (kind == device::quantity::signal)
    return count_range(-128, 0);
  const auto of = std::ranges::find(mote.transducers, kind, &device::transducer_config::kind);
  const auto range =
      of == mote.transducers.end() ? std::nullopt : std::visit(model_range{mote}, of->model);
  if (!range)
    return std::nullopt;
  const auto count = [&](double value) {
    return static_cast<std::int64_t>(
        std::clamp(std::floor(value / of->resolution + 0.5), count_min, count_max));
  };
  return count_range(count(range->first - deviations * of->noise),
                     count(range->second + deviations * of->noise));
}

std::optional<count_range> counts_of(const mote_description& mote, const sampler_app& sampler,
                                     const proxy::field& field) {
  const auto size = proxy::octets_of(field.layout);
  const auto index = field.offset / 2;
  if (size != 2 || field.offset % 2 != 0 || index >= sampler.transducers.size())
    return std::nullopt;
  const auto found = counts_of(mote, sampler.transducers[index]);
  if (field.layout == proxy::encoding::u16 && found && found->first < 0)
    return std::nullopt; // they wrap
  return found;
}

std::optional<count_range> counts_of(const mote_description& mote, const actuator_app& app,
                                     const proxy::field& field) {
  if (field.layout != proxy::encoding::u8 || field.offset != 0)
    return std::nullopt;
  const auto of = std::ranges::find(mote.actuators, app.actuator, &device::actuator_config::name);
  const bool is_relay = of != mote.actuators.end() && of->kind == device::actuator_kind::relay;
  return count_range(0, is_relay ? 1 : 255);
}

} // namespace

bool may_send_anything(const mote_description& mote) {
  return std::ranges::any_of(mote.apps, [](const auto& app) {
    return std::holds_alternative<apps::app_config>(app) ||
           std::holds_alternative<separate_app>(app) ||
           std::holds_alternative<member_app>(app); // values of whatever length
  });
}

std::optional<count_range> counts_of(const mote_description& mote, const proxy::field& field) {
  if (field.stream || may_send_anything(mote))
    return std::nullopt;
  for (const auto& app : mote.apps) {
    if (const auto* sampler = std::get_if<sampler_app>(&app);
        sampler != nullptr && sampler->channel == field.channel)
      return counts_of(mote, *sampler, field);
    if (const auto* actuator = std::get_if<actuator_app>(&app);
        actuator != nullptr && actuator->channel == field.channel)
      return counts_of(mote, *actuator, field);
  }
  return std::nullopt;
}

} // namespace rubicon::config
