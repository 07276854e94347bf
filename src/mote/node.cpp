#include "mote/node.hpp"

#include <algorithm>

#include "mote/transducer.hpp"
#include "network/am.hpp"

namespace rubicon::mote {

namespace {

descriptor describe(const node_config& config) {
  descriptor x;
  x.type = config.type;
  for (const auto& transducer : config.transducers)
    x.transducer_mask |= 1U << static_cast<unsigned>(transducer.kind);
  for (const auto& actuator : config.actuators)
    x.actuator_mask |= 1U << static_cast<unsigned>(actuator.kind);
  x.keep_alive_ms = static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(config.keep_alive).count());
  return x;
}

void append(node_outputs& to, node_outputs from) {
  std::ranges::move(from, std::back_inserter(to));
}

} // namespace

node::node(node_config config, std::uint32_t incarnation, random_stream dice)
    : config_(std::move(config)), dice_(dice), star_(config_.id) {
  join_config join;
  join.keep_alive = config_.keep_alive;
  join_ = join_client(join, encode(describe(config_)), incarnation, random_stream(dice_.next()));
  transport::endpoint_config messages;
  messages.self = config_.id;
  endpoint_ = transport::endpoint(messages, random_stream(dice_.next()));
  for (const auto& actuator : config_.actuators)
    actuator_states_[actuator.name] = actuator.initial;
}

node_outputs node::start(instant now) {
  return take(join_.start(now));
}

node_outputs node::leave() {
  auto out = take(join_.leave());
  star_.leave();
  for (auto& x : endpoint_.fail_all())
    out.emplace_back(std::get<transport::outcome>(x));
  return out;
}

std::optional<node_outputs> node::send(transport::ticket id, mote_address destination,
                                       std::uint8_t am_type, bytes payload, bool reliable,
                                       instant now) {
  if (!joined())
    return std::nullopt;
  auto accepted = endpoint_.send(id, destination, am_type, std::move(payload), reliable, now);
  if (!accepted)
    return std::nullopt;
  return take(*std::move(accepted), now);
}

std::optional<std::int16_t> node::read(quantity kind, instant now) {
  const auto found = std::ranges::find(config_.transducers, kind, &transducer_config::kind);
  if (found == config_.transducers.end())
    return std::nullopt;
  return sample(*found, now, dice_);
}

bool node::actuate(const std::string& name, std::uint8_t state) {
  const auto found = std::ranges::find(config_.actuators, name, &actuator_config::name);
  if (found == config_.actuators.end() || (found->kind == actuator_kind::relay && state > 1))
    return false;
  actuator_states_[name] = state;
  return true;
}

std::optional<std::uint8_t> node::actuator_state(const std::string& name) const {
  const auto found = actuator_states_.find(name);
  if (found == actuator_states_.end())
    return std::nullopt;
  return found->second;
}

node_outputs node::on_frame(mote_id source, std::uint8_t am_type, byte_view payload, instant now) {
  if (am_type == network::am::component_management) {
    const auto message = decode_management(payload);
    if (!message) {
      ++counters_.malformed;
      return {};
    }
    return take(join_.on_message(source, *message, now));
  }
  if (network::star::owns(am_type) && joined())
    return take(star_.on_frame(am_type, payload), now);
  ++counters_.unknown_type;
  return {};
}

node_outputs node::on_time(instant now) {
  auto out = take(join_.on_time(now));
  append(out, take(endpoint_.on_time(now), now));
  return out;
}

std::optional<instant> node::deadline() const {
  return earliest(join_.deadline(), endpoint_.deadline());
}

node_outputs node::take(join_outputs from_join) {
  node_outputs out;
  for (auto& x : from_join) {
    if (auto* frame = std::get_if<to_radio>(&x)) {
      out.emplace_back(network::transmit{frame->destination, network::am::component_management,
                                         encode(frame->message)});
    } else if (const auto* joined = std::get_if<island_joined>(&x)) {
      star_.join(joined->island, joined->sink);
      out.emplace_back(membership{true, joined->island});
    } else {
      star_.leave();
      out.emplace_back(membership{});
    }
  }
  return out;
}

node_outputs node::take(network::outputs from_network, instant now) {
  node_outputs out;
  for (auto& x : from_network) {
    if (auto* frame = std::get_if<network::transmit>(&x)) {
      if (frame->next_hop == star_.sink())
        join_.on_sent(now);
      out.emplace_back(std::move(*frame));
    } else {
      const auto& segment = std::get<network::arrived>(x);
      append(out, take(endpoint_.on_segment(segment.source_island, segment.segment, now), now));
    }
  }
  return out;
}

node_outputs node::take(transport::outputs from_transport, instant now) {
  node_outputs out;
  for (auto& x : from_transport) {
    if (auto* packet = std::get_if<transport::to_network>(&x))
      append(out, take(star_.send(packet->destination, packet->channel, std::move(packet->segment)),
                       now));
    else if (auto* message = std::get_if<transport::received>(&x))
      out.emplace_back(std::move(*message));
    else
      out.emplace_back(std::get<transport::outcome>(x));
  }
  return out;
}

} // namespace rubicon::mote
