#include "communication/ports/channel_port.hpp"

#include <algorithm>

#include "core/account/message_ledger.hpp"
#include "synaptic/message.hpp"

namespace rubicon::communication {

namespace {

/// Handles of tunnels: no channel of Network begins at broadcast.
constexpr std::uint32_t tunnel_handles = 0xffff'0000;

stream::channel_handle handle_of(transport::tunnel_id x) {
  return stream::channel_handle(tunnel_handles | (x.value & 0xffff));
}

message_kind kind_of(stream::channel_handle x) {
  return channel_port::is_tunnel(x) ? message_kind::tunnel : message_kind::channel;
}

transport::tunnel_id tunnel_of(stream::channel_handle x) {
  return transport::tunnel_id(x.value & 0xffff);
}

} // namespace

channel_port::channel_port(local_node& node, const transport::messenger& messages,
                           const transport::tunnels_config& tunnels)
    : node_(node), messages_(messages), tunnels_(tunnels) {}

void channel_port::set_users(channel_user& streams, channel_user& synaptic) {
  streams_ = &streams;
  synaptic_ = &synaptic;
}

bool channel_port::is_tunnel(stream::channel_handle x) {
  return x.value >= tunnel_handles;
}

void channel_port::connect(channel_request who, mote_address destination,
                           std::chrono::milliseconds interval, std::size_t size, std::uint8_t qos) {
  if (const auto most = stream::latency_asked(qos))
    latencies_asked_[who] = *most;
  const bool is_near = destination.island == node_.address().island &&
                       destination.mote != no_mote && node_.config.self != no_mote;
  if (is_near) {
    node_.outputs.emplace_back(channel_wanted{who, destination.mote, interval, size});
    return;
  }
  auto [id, todo] = tunnels_.connect(destination, node_.now);
  connecting_[id] = who;
  apply(std::move(todo));
}

void channel_port::apply(transport::tunnels_outputs todo, bool in_slot) {
  for (auto& x : todo) {
    if (auto* packet = std::get_if<transport::packet_out>(&x)) {
      node_.outputs.emplace_back(transport::to_network{
          packet->destination, transport::tunnel_channel, std::move(packet->octets), in_slot});
    } else if (const auto* open = std::get_if<transport::tunnel_connected>(&x)) {
      if (const auto who = connecting_.extract(open->id); who)
        on_connected(*who, handle_of(open->id), node_.now);
    } else if (const auto* offered = std::get_if<transport::tunnel_accepted>(&x)) {
      on_accepted(handle_of(offered->id), offered->source, node_.now);
    } else if (auto* content = std::get_if<transport::tunnel_received>(&x)) {
      on_octets(handle_of(content->id), content->content, node_.now);
    } else {
      const auto id = std::get<transport::tunnel_ended>(x).id;
      if (const auto who = connecting_.extract(id); who)
        on_connect_failed(*who, node_.now);
      else
        on_closed(handle_of(id), node_.now);
    }
  }
}

void channel_port::send(stream::channel_handle channel, bytes octets, bool in_slot) {
  const mote_address sender{node_.island.value_or(node_.config.home), node_.config.self};
  const acting_on its_copies(begin_message(kind_of(channel), sender, {}));
  if (!is_tunnel(channel))
    node_.outputs.emplace_back(channel_packet{channel, std::move(octets), in_slot});
  else if (auto todo = tunnels_.send(tunnel_of(channel), octets, node_.now))
    apply(*std::move(todo), in_slot);
}

void channel_port::disconnect(stream::channel_handle channel) {
  is_synaptic_.erase(channel);
  latency_bounds_.erase(channel);
  if (is_tunnel(channel))
    apply(tunnels_.close(tunnel_of(channel)));
  else
    node_.outputs.emplace_back(channel_unwanted{channel});
}

/// What comes over gateways takes as long as twice the set-up did, there and back, more for radios
/// that sleep at another moment, and for what is before it in queues.
std::optional<duration> channel_port::latency_bound(stream::channel_handle channel) const {
  constexpr duration queues = 250ms;
  if (is_tunnel(channel)) {
    const auto route = tunnels_.route_of(tunnel_of(channel));
    if (!route)
      return messages_.config().lifetime;
    const auto slack = messages_.slack_to(route->peer);
    return std::min(messages_.config().lifetime, 2 * route->round_trip + queues) + slack;
  }
  const auto found = latency_bounds_.find(channel);
  return found == latency_bounds_.end() ? std::nullopt : std::optional(found->second);
}

/// Whoever has asked for less than the route can promise does not get it.
void channel_port::on_connected(channel_request who, stream::channel_handle channel, instant now) {
  node_.now = now;
  if (const auto asked = latencies_asked_.extract(who); asked) {
    const auto bound = latency_bound(channel);
    if (!bound || *bound > *asked) {
      ++node_.counters.too_slow;
      disconnect(channel);
      on_connect_failed(who, now);
      return;
    }
  }
  is_synaptic_[channel] = who.is_synaptic;
  user(who.is_synaptic).on_connected(who.descriptor, channel);
}

void channel_port::on_connect_failed(channel_request who, instant now) {
  node_.now = now;
  latencies_asked_.erase(who);
  user(who.is_synaptic).on_connect_failed(who.descriptor);
}

void channel_port::on_accepted(stream::channel_handle channel, mote_address source, instant now) {
  node_.now = now;
  unclaimed_.emplace_back(channel, source);
  if (unclaimed_.size() <= node_.config.unclaimed_max)
    return;
  ++node_.counters.unclaimed;
  const auto oldest = unclaimed_.front().first;
  unclaimed_.erase(unclaimed_.begin());
  disconnect(oldest);
}

void channel_port::on_octets(stream::channel_handle channel, byte_view octets, instant now) {
  node_.now = now;
  const auto fresh = std::ranges::find(unclaimed_, channel,
                                       &std::pair<stream::channel_handle, mote_address>::first);
  if (fresh != unclaimed_.end()) {
    const auto source = fresh->second;
    unclaimed_.erase(fresh);
    const bool learns = synaptic::is_synaptic(octets);
    is_synaptic_[channel] = learns;
    user(learns).on_accepted(channel, source, messages_.far_slack(source));
  }
  const auto is_used_by = is_synaptic_.find(channel);
  if (is_used_by == is_synaptic_.end()) {
    note_loss(loss::channel_closed);
    return;
  }
  note_arrival(kind_of(channel),
               is_tunnel(channel) ? tunnels_.peer_of(tunnel_of(channel)) : std::nullopt);
  user(is_used_by->second).on_octets(channel, octets);
}

void channel_port::on_closed(stream::channel_handle channel, instant now) {
  node_.now = now;
  std::erase_if(unclaimed_, [channel](const auto& x) { return x.first == channel; });
  latency_bounds_.erase(channel);
  if (const auto is_synaptic = is_synaptic_.extract(channel))
    user(*is_synaptic).on_closed(channel);
}

void channel_port::on_tunnel_packet(island_id source, byte_view octets) {
  apply(tunnels_.on_packet(source, octets, node_.now));
}

void channel_port::on_time() {
  apply(tunnels_.on_time(node_.now));
}

} // namespace rubicon::communication
