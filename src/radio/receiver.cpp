#include "radio/receiver.hpp"

#include <algorithm>

namespace rubicon::radio {

verdict receiver::on_frame(const frame& x, duration service, energy_meter& mcu, instant now) {
  if (!wanted(x))
    return verdict::filtered;
  const auto waiting = std::upper_bound(served_at_.begin(), served_at_.end(), now);
  served_at_.erase(served_at_.begin(), waiting);
  if (served_at_.size() >= slots_)
    return verdict::overflow;
  served_at_.push_back(mcu.work(service, now));
  return addressed(x) && repeated(x, now) ? verdict::duplicate : verdict::accepted;
}

void receiver::reset() {
  served_at_.clear();
  last_.clear();
}

bool receiver::repeated(const frame& x, instant now) {
  const auto [entry, is_new] = last_.try_emplace(x.source, memory_entry{x.dsn, now});
  if (is_new)
    return false;
  auto& last = entry->second;
  const bool repeat = last.dsn == x.dsn && now - last.heard_at <= memory_;
  if (!repeat)
    last = {x.dsn, now};
  return repeat;
}

} // namespace rubicon::radio
