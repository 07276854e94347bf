#include "peis/kernel_clients.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

subscription_id kernel_clients::watch(client_id who, std::uint64_t name) {
  const subscription_id id{next_watch_++};
  watches_[id] = {who, name, {}};
  return id;
}

request_id kernel_clients::request(client_id who, std::uint64_t token) {
  const request_id id{next_request_++};
  requests_[id] = {who, token, {}};
  return id;
}

bool kernel_clients::hook(client_id who, std::uint16_t port) {
  return ports_.try_emplace(port, who).first->second == who;
}

kernel_clients::outputs kernel_clients::watch_subscribers(client_id who, std::string first_part,
                                                          const kernel& of, instant now) {
  subscribers_watcher_ = who;
  subscribers_first_part_ = std::move(first_part);
  subscribers_version_.reset();
  outputs out;
  review_subscribers(of, now, out);
  return out;
}

kernel_clients::outputs kernel_clients::watch_clock(client_id who, const kernel& of) {
  clock_watchers_.push_back(who);
  return {clock_notice{who, of.network().clock.offset()}};
}

kernel_clients::outputs kernel_clients::forget(client_id who) {
  outputs out;
  if (subscribers_watcher_ == who) {
    subscribers_watcher_.reset();
    subscribers_due_.reset();
  }
  std::erase(clock_watchers_, who);
  std::erase_if(ports_, [&](const auto& x) { return x.second == who; });
  std::erase_if(requests_, [&](const auto& x) { return x.second.client == who; });
  std::erase_if(watches_, [&](const auto& x) {
    const bool ends = x.second.client == who;
    if (ends)
      out.emplace_back(withdraw{x.first});
    return ends;
  });
  return out;
}

kernel_clients::outputs kernel_clients::on(const tuple_changed& x) const {
  return notify_watch(x.subscription, x.content, false, x.content->from);
}

kernel_clients::outputs kernel_clients::on(const tuple_deleted& x) const {
  return notify_watch(x.subscription, x.content, true, x.from);
}

kernel_clients::outputs kernel_clients::notify_watch(subscription_id which,
                                                     const tuple_pointer& content, bool gone,
                                                     provenance from) const {
  const auto found = watches_.find(which);
  if (found == watches_.end())
    return {};
  return {tuple_notice{found->second.client, found->second.name, content, gone, from}};
}

kernel_clients::outputs kernel_clients::on(message x) const {
  const auto found = ports_.find(x.port);
  if (found == ports_.end())
    return {};
  return {message_notice{found->second, x.source, x.port, std::move(x.octets), x.from}};
}

kernel_clients::outputs kernel_clients::on(const outcome& x) {
  const auto found = requests_.find(x.request);
  if (found == requests_.end())
    return {};
  const auto asked = found->second;
  requests_.erase(found);
  return {outcome_notice{asked.client, asked.name, x.success, x.why, asked.from}};
}

kernel_clients::outputs kernel_clients::review(const kernel& x, instant now) {
  outputs out;
  review_subscribers(x, now, out);
  const auto offset = x.network().clock.offset();
  if (std::exchange(clock_sent_, offset) != offset) {
    for (const auto who : clock_watchers_)
      out.emplace_back(clock_notice{who, offset});
  }
  return out;
}

void kernel_clients::review_subscribers(const kernel& x, instant now, outputs& out) {
  const auto version = x.reader().subscribers_version();
  if (!subscribers_watcher_ || subscribers_version_ == version)
    return;
  const bool first = !subscribers_version_;
  const auto count = subscribers_sent_.size();
  const auto next = subscribers_sent_at_ + 10us * count;
  if (!first && count > keys_unpaced && now < next) {
    subscribers_due_ = next;
    return;
  }
  subscribers_due_.reset();
  subscribers_sent_at_ = now;
  subscribers_version_ = version;
  const auto keys = x.reader().subscribed(subscribers_first_part_);
  if (!first && std::ranges::equal(keys, subscribers_sent_))
    return;
  subscribers_sent_.assign(keys.begin(), keys.end());
  out.emplace_back(subscribers_notice{*subscribers_watcher_, subscribers_sent_});
}

} // namespace rubicon::peis
