#include "traffic/packet_memory.hpp"

namespace rubicon::traffic {

bool packet_memory::numbers::has(std::uint64_t number) const {
  return number <= newest && newest - number < window && (seen >> (newest - number) & 1) != 0;
}

bool packet_memory::numbers::insert(std::uint64_t number) {
  if (seen == 0 || number > newest) {
    const auto step = seen == 0 ? window : number - newest;
    seen = (step < window ? seen << step : 0) | 1;
    newest = number;
    return true;
  }
  if (newest - number >= window || has(number))
    return false;
  seen |= std::uint64_t{1} << (newest - number);
  return true;
}

std::optional<novelty> packet_memory::note(mote_id origin, mote_id last_hop, std::uint64_t number) {
  auto path = paths_.end();
  std::size_t last_hops = 0;
  bool seen_elsewhere = false;
  for (auto x = paths_.lower_bound({origin, mote_id{}});
       x != paths_.end() && x->first.first == origin; ++x) {
    ++last_hops;
    if (x->first.second == last_hop)
      path = x;
    else if (x->second.has(number))
      seen_elsewhere = true;
  }
  if (path == paths_.end()) {
    if (last_hops >= last_hops_max || paths_.size() >= paths_max)
      return {};
    path = paths_.emplace(std::pair(origin, last_hop), numbers{}).first;
  }
  if (!path->second.insert(number))
    return novelty::repeated;
  return seen_elsewhere ? novelty::returned : novelty::fresh;
}

} // namespace rubicon::traffic
