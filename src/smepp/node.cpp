#include "smepp/node.hpp"

#include <algorithm>

namespace rubicon::smepp {

namespace {

peer_config peer_config_of(const node_config& x) {
  peer_config out;
  out.self = x.self;
  out.transducers = x.transducers;
  out.has_system_randomness = x.is_real;
  out.saves_energy = x.settings.saves_energy;
  out.energy = x.settings.energy;
  out.event_window = x.settings.event_window;
  out.events.authenticates_sender = x.settings.authenticates_sender;
  if (x.settings.authenticates_sender)
    for (const auto other : x.others)
      out.pairwise.emplace_back(
          other, pairwise_key(x.settings.pairwise_root.value_or(key()), x.self, other));
  // A question has to meet a window of each group that may be there.
  for (const auto& [config, description] : x.members) {
    out.groups.discovery.patience =
        std::max(out.groups.discovery.patience, description.management.period + 1s);
    if (description.master)
      out.masters[description.name] = *description.master;
  }
  return out;
}

constexpr transducer_mask bit(std::string_view name) {
  const auto at = std::ranges::find(transducer_names, name);
  return transducer_mask{1} << (at - transducer_names.begin());
}

} // namespace

transducer_mask mask_of(device::quantity x) {
  switch (x) {
  case device::quantity::temperature:
    return bit("temperature");
  case device::quantity::humidity:
    return bit("humidity");
  case device::quantity::light:
    return bit("light");
  case device::quantity::voltage:
    return bit("voltage");
  case device::quantity::presence:
    return bit("presence");
  case device::quantity::acceleration:
    return bit("accelerometer");
  case device::quantity::magnetism:
    return bit("magnetometer");
  case device::quantity::sound:
    return bit("microphone");
  case device::quantity::signal:
    return bit("rssi");
  }
  return 0; // a quantity of the file's own
}

/// Collects what members ask of their mote.
class node::host final : public member_host {
public:
  host(const reader& reads, node_outputs& out) : reads_(reads), out_(out) {}

  std::optional<std::int16_t> read(device::quantity x) override {
    return reads_ ? reads_(x) : std::nullopt;
  }
  void forward(std::uint8_t channel, const bytes& value) override {
    out_.emplace_back(forward_event{channel, value});
  }
  void notify(std::string what) override { out_.emplace_back(notable{std::move(what)}); }

private:
  const reader& reads_;
  node_outputs& out_;
};

node::~node() = default;
node::node(node&&) noexcept = default;
node& node::operator=(node&&) noexcept = default;

node::node(node_config config, random_stream rng, instant begin, instant now,
           persistent_state before)
    : peer_(peer_config_of(config), random_stream(rng.next()), now, std::move(before)),
      network_{config.settings.network_key.value_or(key()),
               config.settings.network_mac.value_or(key())} {
  for (auto& [program, description] : config.members)
    members_.emplace_back(std::move(program), std::move(description), begin,
                          random_stream(rng.next()));
}

template <class Turn>
node_outputs node::give_turns(outputs from_peer, instant now, Turn turn) {
  auto out = dispatch(std::move(from_peer), now);
  host here(reader_, out);
  for (auto& x : members_) {
    outputs more;
    turn(x, {peer_, here, now, more});
    std::ranges::move(dispatch(std::move(more), now), std::back_inserter(out));
  }
  return out;
}

node_outputs node::start(instant now) {
  outputs from_peer;
  peer_.smepp_newPeer(network_.confidentiality, network_.integrity, now, from_peer);
  return give_turns(std::move(from_peer), now,
                    [](member_program& x, member_program::environment at) { x.start(at); });
}

node_outputs node::on_frame(mote_id from, mote_id to, byte_view octets, instant at, instant now) {
  outputs from_peer;
  peer_.on_frame(from, to, octets, at, now, from_peer);
  return dispatch(std::move(from_peer), now);
}

node_outputs node::on_sent(std::uint64_t id, bool acked, instant at, instant now) {
  outputs from_peer;
  peer_.on_sent(id, acked, at, now, from_peer);
  return dispatch(std::move(from_peer), now);
}

node_outputs node::set_network_keys(const key_pair& x, instant now) {
  network_ = x;
  outputs from_peer;
  peer_.set_network_keys(x.confidentiality, x.integrity, now, from_peer);
  return dispatch(std::move(from_peer), now);
}

node_outputs node::on_time(instant now) {
  outputs from_peer;
  peer_.on_time(now, from_peer);
  return give_turns(std::move(from_peer), now,
                    [](member_program& x, member_program::environment at) { x.on_time(at); });
}

std::optional<instant> node::deadline() const {
  auto first = peer_.deadline();
  for (const auto& x : members_)
    first = earliest(first, x.deadline());
  return first;
}

/// Signals go to all members, whose commands may lead to more.
node_outputs node::dispatch(outputs from_peer, instant now) {
  node_outputs out;
  host here(reader_, out);
  while (!from_peer.empty()) {
    outputs more;
    for (auto& x : from_peer) {
      if (const auto* const raised = std::get_if<signal>(&x)) {
        for (auto& each : members_)
          each.on_signal(*raised, {peer_, here, now, more});
      } else if (auto* const store = std::get_if<store_state>(&x)) {
        out.emplace_back(std::move(*store));
      } else if (auto* const frame = std::get_if<send_frame>(&x)) {
        out.emplace_back(std::move(*frame));
      } else {
        out.emplace_back(std::get<set_radio>(x));
      }
    }
    from_peer = std::move(more);
  }
  const auto agreements = peer_.groups().counters().agreements;
  if (agreements > agreements_)
    out.emplace_back(
        computes{agreement_time * static_cast<std::int64_t>(agreements - agreements_)});
  agreements_ = agreements;
  return out;
}

} // namespace rubicon::smepp
