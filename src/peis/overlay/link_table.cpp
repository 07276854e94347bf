#include "peis/overlay/link_table.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

namespace {

std::uint64_t tables_per_second(const table_limits& x) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(1, 1s / x.table_gap));
}

} // namespace

link_table::link_table(const p2p_config& config)
    : config_(config),
      queues_(std::make_shared<queues_memory>(queues_memory{config.queues_octets_max})) {}

connection& link_table::add(link_id link, instant now) {
  auto& x = connections_[link];
  x.id = link;
  x.cost = config_.cost_other_host;
  x.out.queue = outgoing_queue(config_.queue, queues_);
  x.routes.table_rate = rate_limit(tables_per_second(config_.tables), 2s, 1s);
  x.in.budget = neighbour_budget(config_.budget);
  x.opened = x.in.last_package = x.in.last_octets = now;
  x.signs.beat_sent = now - 1h; // never yet
  return x;
}

std::optional<connection> link_table::take(link_id link) {
  const auto at = connections_.find(link);
  if (at == connections_.end())
    return std::nullopt;
  std::optional gone(std::move(at->second));
  connections_.erase(at);
  if (gone->neighbour && neighbours_.at(*gone->neighbour) == link) {
    neighbours_.erase(*gone->neighbour);
    for (const auto& [other, x] : connections_) {
      if (x.neighbour == gone->neighbour)
        neighbours_.try_emplace(*gone->neighbour, other);
    }
  }
  return gone;
}

void link_table::bind(connection& x, peer_id neighbour) {
  x.neighbour = neighbour;
  neighbours_.try_emplace(neighbour, x.id);
}

connection* link_table::find(link_id link) {
  const auto at = connections_.find(link);
  return at == connections_.end() ? nullptr : &at->second;
}

const connection* link_table::find(link_id link) const {
  const auto at = connections_.find(link);
  return at == connections_.end() ? nullptr : &at->second;
}

std::size_t link_table::open() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(connections_, [](const auto& x) { return x.second.open; }));
}

std::optional<link_id> link_table::link_to(peer_id neighbour) const {
  const auto at = neighbours_.find(neighbour);
  return at == neighbours_.end() ? std::nullopt : std::optional(at->second);
}

std::vector<link_id> link_table::links_to(peer_id neighbour) const {
  std::vector<link_id> links;
  for (const auto& [link, x] : connections_) {
    if (x.neighbour == neighbour)
      links.push_back(link);
  }
  return links;
}

bool link_table::has_named_link(peer_id host) const {
  return std::ranges::any_of(connections_, [host](const auto& entry) {
    return entry.second.named && entry.second.neighbour == host;
  });
}

std::vector<link_view> link_table::views() const {
  std::vector<link_view> all;
  for (const auto& [link, x] : connections_) {
    all.push_back({link, x.neighbour, x.in.octets, x.out.octets, x.in.loss, x.out.queue.size()});
  }
  return all;
}

} // namespace rubicon::peis
