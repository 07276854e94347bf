#include "gateway/directory.hpp"

#include <algorithm>

namespace rubicon::gateway {

void directory::start(instant now) {
  gap_ = config_.first_gap;
  due_ = now + dice_.between(0s, config_.first_gap);
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
  known_[source] = {source, *said, now};
  if (is_new && due_)
    due_ = std::min(*due_, now + dice_.between(0s, config_.answer_max));
}

bool directory::on_time(instant now) {
  std::erase_if(known_, [&](const auto& x) {
    return x.second.heard + config_.missed_max * config_.period <= now;
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

peer_id directory::gateway_for(island_id island) const {
  const auto primary = rubicon::gateway_of(island);
  if (known_.contains(primary))
    return primary;
  const known_gateway* newest = nullptr;
  for (const auto& [peer, x] : known_) {
    if (x.said.island == island && (newest == nullptr || x.heard > newest->heard))
      newest = &x;
  }
  return newest == nullptr ? primary : newest->peer;
}

island_id directory::island_of(peer_id peer) const {
  const auto found = known_.find(peer);
  return found == known_.end() ? island_id{static_cast<std::uint32_t>(peer.value)}
                               : found->second.said.island;
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
