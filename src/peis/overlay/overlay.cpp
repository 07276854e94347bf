#include "peis/overlay/overlay.hpp"

namespace rubicon::peis {

overlay::overlay(const own_peer& own, link_table& links)
    : own_(own), links_(links),
      routes_(own.self.id, own.self.magic, own.config.metric_limit, own.config.tables.routes) {}

std::optional<link_id> overlay::next_hop(peer_id destination) const {
  const auto direct = links_.link_to(destination);
  return direct ? direct : routes_.way_to(destination);
}

std::vector<link_id> overlay::hops_to(peer_id destination) const {
  auto links = routes_.offers_of(destination);
  if (const auto next = next_hop(destination)) {
    std::erase(links, *next);
    links.insert(links.begin(), *next);
  }
  return links;
}

std::optional<link_id> overlay::any_hop(peer_id destination) const {
  if (const auto hop = next_hop(destination))
    return hop;
  const auto source = sources_.find(destination);
  return source == sources_.end() ? std::nullopt : std::optional(source->second);
}

/// Of each link the newest are kept.
void overlay::note_source(peer_id source, link_id over) {
  if (next_hop(source)) {
    sources_.erase(source);
    return;
  }
  const auto [at, is_new] = sources_.try_emplace(source, over);
  if (!is_new && at->second == over)
    return;
  at->second = over;
  auto& kept = links_.at(over).routes.sources;
  kept.push_back(source);
  if (kept.size() <= own_.config.tables.heard_over)
    return;
  const auto oldest = sources_.find(kept.front());
  kept.pop_front();
  if (oldest != sources_.end() && oldest->second == over && oldest->first != source)
    sources_.erase(oldest);
}

routing_changes overlay::on_link_closed(link_id link, instant now) {
  std::erase_if(sources_, [link](const auto& x) { return x.second == link; });
  return routes_.on_link_closed(link, now);
}

} // namespace rubicon::peis
