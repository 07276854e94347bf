#include "smepp/events/energy.hpp"

#include <algorithm>

namespace rubicon::smepp {

namespace {

/// Windows looked at for the end of one stretch: then the radio is as good as always on.
constexpr int windows_max = 256;

} // namespace

void energy::set(cycle_key key, const duty_cycle& x) {
  cycles_[key] = x;
}

void energy::remove(cycle_key key) {
  cycles_.erase(key);
}

std::optional<energy::stretch> energy::last_window(const duty_cycle& x, instant t) {
  if (t < x.first)
    return std::nullopt;
  const auto begin = x.first + (t - x.first) / x.period * x.period;
  return stretch{begin, begin + x.length};
}

energy::stretch energy::next_window(const duty_cycle& x, instant t) {
  const auto last = last_window(x, t);
  const auto begin = last ? last->begin + x.period : x.first;
  return {begin, begin + x.length};
}

/// When the last of the windows ends that have begun at `t` or before; it may be still to come.
std::optional<instant> energy::last_end(instant t) const {
  std::optional<instant> latest;
  for (const auto& [key, x] : cycles_)
    if (const auto window = last_window(x, t))
      latest = latest ? std::max(*latest, window->end) : window->end;
  return latest;
}

/// When the next window begins, after `t`.
std::optional<instant> energy::next_begin(instant t) const {
  std::optional<instant> first;
  for (const auto& [key, x] : cycles_)
    first = earliest(first, next_window(x, t).begin);
  return first;
}

/// Whether the radio stays on from the end of one window to the begin of another.
bool energy::merges(instant end, instant begin) const {
  return begin - end < std::max(config_.tolerance, 2 * config_.radio_delay);
}

bool energy::is_on(instant now) const {
  const auto end = last_end(now);
  if (end && now < *end + config_.radio_delay)
    return true;
  const auto begin = next_begin(now);
  return begin && (now >= *begin - config_.radio_delay || (end && merges(*end, *begin)));
}

std::optional<instant> energy::next_change(instant now) const {
  if (cycles_.empty())
    return std::nullopt;
  if (!is_on(now))
    return *next_begin(now) - config_.radio_delay;
  auto at = now;
  for (int i = 0; i < windows_max; ++i) {
    const auto end = last_end(at);
    if (end && *end > at) { // inside of a window
      at = *end;
      continue;
    }
    const auto begin = next_begin(at);
    const bool goes_on =
        begin && (at >= *begin - config_.radio_delay || (end && merges(*end, *begin)));
    if (!goes_on)
      return *end + config_.radio_delay;
    at = *begin;
  }
  return at;
}

} // namespace rubicon::smepp
