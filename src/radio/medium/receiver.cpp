#include "radio/medium/receiver.hpp"

#include <algorithm>

namespace rubicon::radio {

verdict receiver::on_frame(const frame& x, bool may_repeat, duration service, energy_meter& mcu,
                           instant now) {
  const auto waiting = std::upper_bound(served_at_.begin(), served_at_.end(), now);
  served_at_.erase(served_at_.begin(), waiting);
  if (served_at_.size() >= slots_)
    return verdict::overflow;
  served_at_.push_back(mcu.work(service, now));
  return may_repeat && repeated(x, now) ? verdict::duplicate : verdict::accepted;
}

void receiver::reset() {
  served_at_.clear();
  last_.clear();
}

std::uint16_t receiver::key_of(mote_id source) const {
  const auto address = source.value;
  return rules_->weak_source_key ? static_cast<std::uint16_t>((address >> 8U) + (address & 0xffU))
                                 : address;
}

bool receiver::repeated(const frame& x, instant now) {
  const auto key = key_of(x.source);
  auto entry = std::ranges::lower_bound(last_, key, {}, &reception::source);
  if (entry != last_.end() && entry->source == key) {
    const bool repeat = entry->dsn == x.dsn && now - entry->at <= memory_;
    if (!repeat)
      *entry = {key, x.dsn, now};
    return repeat;
  }
  if (rules_->sources_max != 0 && last_.size() >= rules_->sources_max) {
    last_.erase(std::ranges::min_element(last_, {}, &reception::at));
    entry = std::ranges::lower_bound(last_, key, {}, &reception::source);
  }
  last_.insert(entry, {key, x.dsn, now});
  return false;
}

} // namespace rubicon::radio
