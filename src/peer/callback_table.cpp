#include "peer/callback_table.hpp"

#include <utility>

namespace rubicon::peer {

peis::subscription_id callback_table::add_watcher(tuple_callback changed, tuple_callback deleted) {
  const peis::subscription_id id{next_subscription_++};
  watchers_[id] = std::make_shared<watcher>(watcher{std::move(changed), std::move(deleted)});
  return id;
}

peis::request_id callback_table::add_request(outcome_callback then) {
  const peis::request_id id{next_request_++};
  if (then)
    expected_.emplace(id, std::move(then));
  return id;
}

std::vector<peer_id> callback_table::take_route(peis::request_id request) {
  return std::move(routes_.extract(request).mapped());
}

void callback_table::add_hook(std::uint16_t port, message_callback hook) {
  hooks_[port].push_back(std::move(hook));
}

callback_table::call callback_table::on(const peis::tuple_changed& x) const {
  const auto found = watchers_.find(x.subscription);
  if (found == watchers_.end() || !found->second->changed)
    return {};
  return [watcher = found->second, content = x.content] { watcher->changed(content); };
}

callback_table::call callback_table::on(const peis::tuple_deleted& x) const {
  const auto found = watchers_.find(x.subscription);
  if (found == watchers_.end() || !found->second->deleted)
    return {};
  return [watcher = found->second, content = x.content] { watcher->deleted(content); };
}

callback_table::call callback_table::on(const peis::outcome& x) {
  const auto found = expected_.find(x.request);
  if (found == expected_.end())
    return {};
  auto then = std::move(found->second);
  expected_.erase(found);
  return [then = std::move(then), x] { then(x); };
}

callback_table::call callback_table::on(const peis::host_appeared& x) const {
  return on_host_ ? call([then = on_host_, host = x.host] { then(host, true); }) : call();
}

callback_table::call callback_table::on(const peis::host_vanished& x) const {
  return on_host_ ? call([then = on_host_, host = x.host] { then(host, false); }) : call();
}

std::vector<message_callback> callback_table::hooks(std::uint16_t port) const {
  const auto found = hooks_.find(port);
  return found == hooks_.end() ? std::vector<message_callback>() : found->second;
}

void callback_table::on(peis::traced& x) {
  const auto found = routes_.find(x.request);
  if (found != routes_.end())
    found->second = std::move(x.route);
}

} // namespace rubicon::peer
