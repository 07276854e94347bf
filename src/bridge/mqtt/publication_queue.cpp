#include "bridge/mqtt/publication_queue.hpp"

#include <utility>

namespace rubicon::bridge {

void publication_queue::add(urgency how, publication x) {
  const auto [at, is_new] = payloads_.insert_or_assign(x.topic, std::move(x.payload));
  if (is_new)
    topics_[static_cast<std::size_t>(how)].push_back(at->first);
  else
    ++replaced_;
}

void publication_queue::clear() {
  for (auto& each : topics_)
    each.clear();
  payloads_.clear();
}

std::vector<publication> publication_queue::take(instant now) {
  std::vector<publication> out;
  if (now >= slot_begins_ + slot) {
    slot_begins_ = now;
    left_ = per_slot_;
  }
  for (auto& each : topics_) {
    while (left_ > 0 && !each.empty()) {
      auto found = payloads_.extract(each.front());
      each.pop_front();
      out.push_back({std::move(found.key()), std::move(found.mapped())});
      --left_;
    }
  }
  return out;
}

std::optional<instant> publication_queue::deadline() const {
  if (payloads_.empty())
    return std::nullopt;
  return left_ > 0 ? slot_begins_ : slot_begins_ + slot;
}

} // namespace rubicon::bridge
