#include "network/tree/source_routes.hpp"

#include <algorithm>

namespace rubicon::network {

void source_routes::learn(mote_id mote, mote_id parent) {
  if (mote == root_ || mote == parent)
    return;
  const auto known = parents_.find(mote);
  if (known == parents_.end() && parents_.size() >= motes_max_)
    parents_.erase(
        std::ranges::min_element(parents_, {}, [](const auto& x) { return x.second.learnt; }));
  parents_[mote] = {parent, ++learnt_};
}

std::optional<std::vector<mote_id>> source_routes::route_to(mote_id mote) const {
  std::vector<mote_id> hops;
  for (auto at = mote; at != root_;) {
    const auto parent = parents_.find(at);
    if (parent == parents_.end() || hops.size() >= hops_max)
      return std::nullopt;
    hops.push_back(at);
    at = parent->second.parent;
  }
  std::ranges::reverse(hops);
  return hops;
}

} // namespace rubicon::network
