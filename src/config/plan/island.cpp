#include "config/plan/island.hpp"

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

} // namespace rubicon::config
