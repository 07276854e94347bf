#include "network/channels/radio_schedule.hpp"

#include <algorithm>

namespace rubicon::network {

radio_schedule::turn radio_schedule::turn_at(const entry& x, island_time now, microseconds guard) {
  const auto& need = x.need;
  const auto from = std::max(now, x.served_until);
  const auto after = need.after + guard;
  // The first turn whose end is after `from`. The time may have begun anew since `first` was agreed
  // on: only its place in the interval counts.
  const auto past = period_number(from - (need.first + after), need.interval) + 1;
  const auto at = need.first + past * need.interval;
  return {at - need.before - guard, at + after};
}

void radio_schedule::served(std::uint64_t key, island_time now, microseconds guard) {
  const auto found = needs_.find(key);
  if (found == needs_.end())
    return;
  const auto present = turn_at(found->second, now, guard);
  if (present.begin <= now)
    found->second.served_until = present.end;
}

bool radio_schedule::is_on(island_time now, microseconds guard) const {
  return std::ranges::any_of(
      needs_, [&](const auto& x) { return turn_at(x.second, now, guard).begin <= now; });
}

std::optional<island_time> radio_schedule::next_change(island_time now, microseconds guard) const {
  std::optional<island_time> next;
  for (const auto& [key, x] : needs_) {
    const auto present = turn_at(x, now, guard);
    const auto change = present.begin > now ? present.begin : present.end;
    if (!next || change < *next)
      next = change;
  }
  return next;
}

} // namespace rubicon::network
