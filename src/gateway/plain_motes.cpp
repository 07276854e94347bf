#include "gateway/plain_motes.hpp"

#include <algorithm>

#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "network/sink_event.hpp"
#include "transport/segment.hpp"

namespace rubicon::gateway {

namespace {

sink_packet event_of(mote_id mote, const network::sink_event& x) {
  return {mote, network::am::sink_event, encode(x)};
}

/// Nobody waits for an answer to it.
sink_packet message_of(mote_id mote, std::uint8_t channel, byte_view payload) {
  transport::segment x;
  x.source = mote;
  x.am_type = channel;
  x.payload = to_bytes(payload);
  return {mote, network::am::to_gateway,
          encode(network::island_packet{own_island, no_mote, channel, encode(x)})};
}

} // namespace

std::optional<std::vector<sink_packet>> plain_motes::on_packet(mote_id source, std::uint8_t am_type,
                                                               byte_view payload, instant now) {
  const auto* rule = rule_for(source, am_type);
  if (rule == nullptr)
    return {};
  std::vector<sink_packet> out;
  if (members_.size() == motes_max && !members_.contains(source))
    return out;
  auto& x = members_[source];
  x.heard = now;
  if (!x.listed) {
    x.listed = true;
    out.push_back(event_of(source, network::mote_joined{source, ++x.lives, rule->type, {}}));
  }
  out.push_back(message_of(source, rule->channel, payload));
  return out;
}

std::vector<sink_packet> plain_motes::on_time(instant now) {
  std::vector<sink_packet> out;
  for (auto& [mote, x] : members_) {
    if (!x.listed || x.heard + config_.keep_alive > now)
      continue;
    x.listed = false;
    out.push_back(event_of(mote, network::mote_left{mote, network::leave_cause::silence}));
  }
  return out;
}

std::optional<instant> plain_motes::deadline() const {
  std::optional<instant> due;
  for (const auto& [mote, x] : members_)
    if (x.listed)
      due = earliest(due, std::optional(x.heard + config_.keep_alive));
  return due;
}

const plain_rule* plain_motes::rule_for(mote_id source, std::uint8_t am_type) const {
  const auto found = std::ranges::find_if(config_.rules, [&](const plain_rule& x) {
    return x.am_type == am_type && x.first <= source.value && source.value <= x.last;
  });
  return found == config_.rules.end() ? nullptr : &*found;
}

} // namespace rubicon::gateway
