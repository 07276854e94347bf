#include "config/ecology.hpp"

namespace rubicon::config {

std::vector<peer_id> gateways_of(const island_description& x) {
  std::vector<peer_id> all{gateway_of(x.id)};
  for (const auto& alias : x.aliases)
    all.push_back(alias.id);
  return all;
}

void sort_plan(std::vector<fault_description>& x) {
  std::ranges::stable_sort(x, {},
                           [](const auto& each) { return std::pair(is_change(each), each.at); });
}

} // namespace rubicon::config
