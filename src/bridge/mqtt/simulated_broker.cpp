#include "bridge/mqtt/simulated_broker.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::bridge {

bool filter_includes(std::string_view filter, std::string_view topic) {
  if (topic.starts_with('$') && !filter.starts_with('$'))
    return false;
  while (true) {
    const auto end = filter.find('/');
    const auto level = filter.substr(0, end);
    if (level == "#")
      return true;
    const auto other = topic.find('/');
    if (level != "+" && level != topic.substr(0, other))
      return false;
    if (end == std::string_view::npos || other == std::string_view::npos)
      return end == other || (other == std::string_view::npos && filter.substr(end + 1) == "#");
    filter.remove_prefix(end + 1);
    topic.remove_prefix(other + 1);
  }
}

void simulated_broker::connect(std::uint32_t client, publication last_will) {
  sessions_[client] = {std::move(last_will), {}};
}

simulated_broker::deliveries simulated_broker::lose(std::uint32_t client) {
  const auto ended = sessions_.extract(client);
  return ended.empty() ? deliveries{} : publish(ended.mapped().last_will, true);
}

simulated_broker::deliveries simulated_broker::subscribe(std::uint32_t client,
                                                         const std::string& filter) {
  deliveries out;
  const auto found = sessions_.find(client);
  if (found == sessions_.end())
    return out;
  found->second.filters.push_back(filter);
  for (const auto& [topic, payload] : retained_)
    if (filter_includes(filter, topic))
      out.push_back({client, topic, payload, true});
  return out;
}

void simulated_broker::unsubscribe(std::uint32_t client, const std::string& filter) {
  if (const auto found = sessions_.find(client); found != sessions_.end())
    std::erase(found->second.filters, filter);
}

simulated_broker::deliveries simulated_broker::publish(const publication& x, bool retain,
                                                       std::uint32_t by) {
  if (retain && x.payload.empty())
    retained_.erase(x.topic);
  else if (retain)
    retained_[x.topic] = x.payload;
  deliveries out;
  for (const auto& [client, its] : sessions_)
    if (client != by && std::ranges::any_of(its.filters, [&x](const auto& filter) {
          return filter_includes(filter, x.topic);
        }))
      out.push_back({client, x.topic, x.payload, false});
  return out;
}

void simulated_broker::restart(bool persistent) {
  sessions_.clear();
  if (!persistent)
    retained_.clear();
}

} // namespace rubicon::bridge
