#include "control/admission.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::control {

admission::decision admission::arrive(id who, const ipv4_address& from, instant now) {
  if (comes_too_often(from, now))
    return {};
  decision out{true, std::nullopt};
  if (count(from) >= limits_.of_address_max)
    out.leaves = remove_oldest(from);
  else if (waiting_.size() >= limits_.all_max)
    out.leaves = remove_oldest(most_numerous());
  waiting_.push_back({who, from});
  return out;
}

void admission::leave(id who) {
  std::erase_if(waiting_, [who](const waiter& x) { return x.who == who; });
}

/// Each connection stands for the time in which one may come; `at_once` of them may be ahead.
bool admission::comes_too_often(const ipv4_address& from, instant now) {
  const auto each = duration(1s) / limits_.per_second;
  const auto is_over = [now](const auto& x) { return now - x.second.at >= x.second.used; };
  if (rations_.size() >= rations_max && !rations_.contains(from)) {
    std::erase_if(rations_, is_over);
    if (rations_.size() >= rations_max)
      rations_.erase(rations_.begin());
  }
  auto& x = rations_[from];
  x.used = std::max(duration{}, x.used - (now - x.at));
  x.at = now;
  if (x.used + each > each * limits_.at_once)
    return true;
  x.used += each;
  return false;
}

std::size_t admission::count(const ipv4_address& from) const {
  return static_cast<std::size_t>(std::ranges::count(waiting_, from, &waiter::from));
}

ipv4_address admission::most_numerous() const {
  std::map<ipv4_address, std::size_t> counts;
  for (const auto& each : waiting_)
    ++counts[each.from];
  return std::ranges::max_element(counts, {}, [](const auto& x) { return x.second; })->first;
}

admission::id admission::remove_oldest(const ipv4_address& from) {
  const auto found = std::ranges::find(waiting_, from, &waiter::from);
  const auto who = found->who;
  waiting_.erase(found);
  return who;
}

} // namespace rubicon::control
