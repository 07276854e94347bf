#include "smepp/events/outbox.hpp"

#include <algorithm>

namespace rubicon::smepp {

bool outbox::push(to_send x, instant now) {
  if (entries_.size() >= capacity_)
    return false;
  auto due = now + x.delay;
  if (x.to == broadcast_mote && x.when != slot::at_once)
    due += rng_.between(duration{}, spread_);
  entries_.push_back({std::move(x), due});
  return true;
}

std::optional<to_send> outbox::take(instant now, const waiting_time& wait) {
  for (auto at = entries_.begin(); at != entries_.end(); ++at) {
    if (at->due > now)
      continue;
    if (const auto until = wait(at->what, now); until.left > duration{}) {
      at->due = now + until.left + rng_.between(duration{}, until.spread);
      continue;
    }
    auto x = at->what;
    if (at->what.copies <= 1) {
      entries_.erase(at);
    } else {
      --at->what.copies;
      at->due = now + rng_.between(spread_, 3 * spread_);
    }
    return x;
  }
  return std::nullopt;
}

std::optional<instant> outbox::deadline() const {
  std::optional<instant> first;
  for (const auto& x : entries_)
    first = earliest(first, x.due);
  return first;
}

std::vector<std::uint64_t> outbox::forget(group_id group) {
  std::vector<std::uint64_t> tokens;
  for (const auto& x : entries_)
    if (x.what.group == group && x.what.token != 0)
      tokens.push_back(x.what.token);
  std::erase_if(entries_, [&](const entry& x) { return x.what.group == group; });
  return tokens;
}

bool outbox::has_urgent() const {
  return std::ranges::any_of(entries_, [](const entry& x) { return x.what.when == slot::at_once; });
}

} // namespace rubicon::smepp
