#include "network/source_routes.hpp"

#include <algorithm>

namespace rubicon::network {

void source_routes::learn(mote_id mote, mote_id parent) {
  if (mote == root_ || mote == parent)
    return;
  const auto known = parents_.find(mote);
  if (known != parents_.end())
    known->second = parent;
  else if (parents_.size() < motes_max_)
    parents_.emplace(mote, parent);
}

std::optional<std::vector<mote_id>> source_routes::route_to(mote_id mote) const {
  std::vector<mote_id> hops;
  for (auto at = mote; at != root_;) {
    const auto parent = parents_.find(at);
    if (parent == parents_.end() || hops.size() >= hops_max)
      return std::nullopt;
    hops.push_back(at);
    at = parent->second;
  }
  std::ranges::reverse(hops);
  return hops;
}

} // namespace rubicon::network
