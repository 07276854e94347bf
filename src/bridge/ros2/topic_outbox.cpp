#include "bridge/ros2/topic_outbox.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::bridge {

std::size_t topic_outbox::add_topic(limits x) {
  lines_.push_back({x, {}, {}});
  return lines_.size() - 1;
}

void topic_outbox::add(std::size_t topic, std::string message, instant now) {
  auto& to = lines_[topic];
  if (to.waiting.size() >= to.limit.waiting_max) {
    to.waiting.pop_front();
    ++dropped_;
    --size_;
  } else if (to.waiting.empty())
    turns_.emplace(std::max(now, to.free_at), turn_++, topic);
  to.waiting.push_back(std::move(message));
  longest_ = std::max(longest_, ++size_);
}

void topic_outbox::clear() {
  for (auto& each : lines_)
    each.waiting.clear();
  turns_.clear();
  size_ = 0;
}

std::vector<std::string> topic_outbox::take(std::size_t most, instant now) {
  std::vector<std::string> out;
  while (out.size() < most && !turns_.empty() && std::get<instant>(*turns_.begin()) <= now) {
    const auto topic = std::get<2>(*turns_.begin());
    turns_.erase(turns_.begin());
    auto& from = lines_[topic];
    out.push_back(std::move(from.waiting.front()));
    from.waiting.pop_front();
    --size_;
    from.free_at = now + from.limit.every;
    if (!from.waiting.empty())
      turns_.emplace(from.free_at, turn_++, topic);
  }
  return out;
}

std::optional<instant> topic_outbox::deadline() const {
  if (turns_.empty())
    return std::nullopt;
  return std::get<instant>(*turns_.begin());
}

} // namespace rubicon::bridge
