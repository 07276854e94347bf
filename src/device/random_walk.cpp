#include "device/random_walk.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/hash.hpp"
#include "core/numbers/random.hpp"

namespace rubicon::device {

namespace {

constexpr std::int64_t step_ns = std::int64_t{1} << 20U;

/// The deviate that belongs to one point of time.
double deviate(std::uint64_t seed, std::int64_t time_ns) {
  return random_stream::fixed_normal(seed + static_cast<std::uint64_t>(time_ns));
}

/// Lévy's construction: the middle of an interval is the mean of its ends and a deviate whose
/// variance is a quarter of its length.
double path_at(std::uint64_t seed, duration time) {
  const auto t = std::clamp(time, duration(0), random_walk_end).count();
  std::int64_t from = 0;
  std::int64_t to = random_walk_end.count();
  double at_from = 0;
  double at_to = std::sqrt(seconds(random_walk_end)) * deviate(seed, to);
  while (to - from > step_ns) {
    const auto middle = from + (to - from) / 2;
    const auto spread = std::sqrt(seconds(duration(to - from))) / 2;
    const auto at_middle = (at_from + at_to) / 2 + spread * deviate(seed, middle);
    (t < middle ? to : from) = middle;
    (t < middle ? at_to : at_from) = at_middle;
  }
  return at_from + (at_to - at_from) * static_cast<double>(t - from) / static_cast<double>(step_ns);
}

} // namespace

/// What is drawn anew begins where the walk was.
double brownian(std::uint64_t seed, duration time) {
  const auto anew = reseeding::current();
  if (!anew || time <= anew->since.time_since_epoch())
    return path_at(seed, time);
  const auto since = anew->since.time_since_epoch();
  const auto other = fold64(seed).add(anew->key).value();
  return path_at(seed, since) + path_at(other, time) - path_at(other, since);
}

double reflected(double x, double min, double max) {
  assert(min < max);
  const auto span = max - min;
  const auto turns = (x - min) / (2 * span); // there and back again
  const auto along = 2 * span * (turns - std::floor(turns));
  return std::clamp(min + (along > span ? 2 * span - along : along), min, max);
}

} // namespace rubicon::device
