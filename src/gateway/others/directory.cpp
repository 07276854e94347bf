#include "gateway/others/directory.hpp"

#include <algorithm>

namespace rubicon::gateway {

void directory::start(instant now) {
  gap_ = config_.first_gap;
  due_ = now + rng_.between(0s, config_.first_gap);
}

void directory::on_announcement(peer_id source, byte_view octets, instant now) {
  ++counters_.heard;
  auto said = decode_announcement(octets);
  if (!said) {
    ++counters_.foreign;
    said =
        announcement{island_id{static_cast<std::uint32_t>(source.value)}, wire_form::strict54, 0};
  }
  const auto found = known_.find(source);
  const bool is_new = found == known_.end() || found->second.said.incarnation != said->incarnation;
  if (found == known_.end() && known_.size() >= config_.gateways_max) {
    ++counters_.refused;
    return;
  }
  const bool claims = said->leads.value_or(false);
  const bool claimed = found != known_.end() && found->second.said.leads.value_or(false);
  const auto since = claims && claimed ? found->second.claimed : now;
  known_[source] = {source, *said, now, since};
  const bool has_room = aliases_.contains(source) || aliases_.size() < config_.gateways_max;
  if (gateway_of(said->island) != source && has_room)
    aliases_[source] = said->island;
  if (is_new && due_)
    due_ = std::min(*due_, now + rng_.between(0s, config_.answer_max));
}

bool directory::on_time(instant now) {
  std::erase_if(known_, [&](const auto& x) {
    return x.second.last_received + config_.missed_max * config_.period <= now;
  });
  if (!due_ || *due_ > now)
    return false;
  due_ = now + gap_;
  gap_ = std::min(2 * gap_, config_.period);
  return true;
}

std::optional<instant> directory::deadline() const {
  return due_;
}

std::optional<peer_id> directory::leader_of(island_id island) const {
  const known_gateway* last = nullptr;
  for (const auto& [peer, x] : known_) {
    if (x.said.island == island && x.said.leads.value_or(false) &&
        (last == nullptr || x.claimed > last->claimed))
      last = &x;
  }
  return last == nullptr ? std::nullopt : std::optional(last->peer);
}

island_id directory::meant_by(island_id x) const {
  const auto found = aliases_.find(gateway_of(x));
  return found == aliases_.end() ? x : found->second;
}

peer_id directory::gateway_for(island_id called) const {
  const auto island = meant_by(called);
  if (const auto leader = leader_of(island))
    return *leader;
  const auto primary = rubicon::gateway_of(island);
  if (known_.contains(primary))
    return primary;
  const known_gateway* newest = nullptr;
  for (const auto& [peer, x] : known_) {
    if (x.said.island == island && (newest == nullptr || x.last_received > newest->last_received))
      newest = &x;
  }
  return newest == nullptr ? primary : newest->peer;
}

island_id directory::island_of(peer_id peer) const {
  const island_id own{static_cast<std::uint32_t>(peer.value)};
  const auto found = known_.find(peer);
  return found == known_.end() ? meant_by(own) : found->second.said.island;
}

wire_form directory::form_of(peer_id peer) const {
  const auto found = known_.find(peer);
  return found == known_.end() ? wire_form::segment : found->second.said.form;
}

std::vector<known_gateway> directory::known() const {
  std::vector<known_gateway> all;
  for (const auto& [peer, x] : known_)
    all.push_back(x);
  return all;
}

} // namespace rubicon::gateway
