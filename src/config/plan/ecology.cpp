#include "config/plan/ecology.hpp"

#include <algorithm>

namespace rubicon::config {

peer_description::peer_description() = default;
peer_description::~peer_description() = default;
peer_description::peer_description(const peer_description&) = default;
peer_description& peer_description::operator=(const peer_description&) = default;
peer_description::peer_description(peer_description&&) noexcept = default;
peer_description& peer_description::operator=(peer_description&&) noexcept = default;

bool has_real_links(const peer_description& x) {
  return x.tcp || x.lan || !x.connect.empty() || !x.adapter.empty();
}

ecology_description::ecology_description() = default;
ecology_description::~ecology_description() = default;
ecology_description::ecology_description(const ecology_description&) = default;
ecology_description& ecology_description::operator=(const ecology_description&) = default;
ecology_description::ecology_description(ecology_description&&) noexcept = default;
ecology_description& ecology_description::operator=(ecology_description&&) noexcept = default;

void sort_plan(std::vector<fault_description>& x) {
  std::ranges::stable_sort(x, {},
                           [](const auto& each) { return std::pair(is_change(each), each.at); });
}

} // namespace rubicon::config
