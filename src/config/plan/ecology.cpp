#include "config/plan/ecology.hpp"

#include <algorithm>

namespace rubicon::config {

mote_description::mote_description() = default;
mote_description::~mote_description() = default;
mote_description::mote_description(const mote_description&) = default;
mote_description& mote_description::operator=(const mote_description&) = default;
mote_description::mote_description(mote_description&&) noexcept = default;
mote_description& mote_description::operator=(mote_description&&) noexcept = default;

island_description::island_description() = default;
island_description::~island_description() = default;
island_description::island_description(const island_description&) = default;
island_description& island_description::operator=(const island_description&) = default;
island_description::island_description(island_description&&) noexcept = default;
island_description& island_description::operator=(island_description&&) noexcept = default;

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

bool has_plain_sink(const island_description& x) {
  return x.outside.has_sink() || x.stack == stack::plain;
}

std::uint8_t channel_of(const island_description& island, const mote_description& mote) {
  return mote.channel.value_or(island.channel);
}

duration silence_max(const island_description& x) {
  return std::max({x.keep_alive, x.duty.silence_min(), x.listening.silence_min()});
}

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
