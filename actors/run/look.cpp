#include "actors/run/look.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <variant>

#include "actors/base/statuses.hpp"
#include "actors/island/air.hpp"
#include "actors/island/mote.hpp"
#include "actors/island/sink.hpp"
#include "actors/messages/services.hpp"
#include "actors/peis/peis_peer.hpp"
#include "actors/serial/serial_line.hpp"
#include "actors/services/gateway.hpp"
#include "report/report_parts.hpp"
#include "report/run_counters.hpp"

namespace rubicon {

namespace {

/// nullptr: it has ended, and its state with it, though its supervisor has not received that yet.
template <class State, class Handle>
const State* state_of(const Handle& x) {
  if (!x)
    return nullptr;
  const auto& who =
      static_cast<const scheduler::shell<State, typename Handle::interface>&>(x.get());
  return who.has_ended() ? nullptr : &who.state;
}

/// Its neighbours, and what it has sent over the tree.
void add_network(report::mote_sample& to, const network::router& from) {
  for (const auto& each : from.links().all()) {
    report::neighbour_sample x{each.mote};
    if (const auto etx = from.links().etx(each))
      x.etx = static_cast<double>(*etx) / network::etx_one;
    to.neighbours.push_back(x);
  }
  to.queued = static_cast<std::uint32_t>(from.packets().queued());
  to.originated = from.packets().counters().originated;
  to.forwarded = from.packets().counters().forwarded;
}

/// What it knows of the route to its sink.
void add_route(report::mote_sample& to, const mote::node& from) {
  const auto& router = from.packets().router();
  if (!router.tree().has_route())
    return;
  to.parent = router.tree().parent();
  to.hops = router.tree().hops();
  if (from.devices().parent_dbm() != mote::mote_devices::signal_unknown)
    to.signal_dbm = from.devices().parent_dbm();
  if (const auto etx = router.links().etx(to.parent))
    to.etx = static_cast<double>(*etx) / network::etx_one;
}

/// The same of one that may be of another kind: nullptr then.
template <class State, class Interface>
const State* state_if(const caf::abstract_actor* x) {
  const auto* who = dynamic_cast<const scheduler::shell<State, Interface>*>(x);
  return who == nullptr || who->has_ended() ? nullptr : &who->state;
}

/// The gateway among a peer's programs; nullptr: it has none, or it has ended.
const gateway_state* gateway_at(const supervised_peer& x) {
  for (const auto& each : x.programs)
    if (const auto* gateway = state_if<gateway_state, gateway_interface>(each->get()))
      return gateway;
  return nullptr;
}

report::peer_sample sample_of(const supervised_peer& from) {
  report::peer_sample x;
  x.name = from.name;
  const auto* const kernel = state_of<peis_peer_state>(from.handle);
  x.runs = kernel != nullptr && !kernel->left;
  if (!x.runs)
    return x;
  for (const auto& link : kernel->kernel.network().links.views())
    x.links.push_back({link.neighbour.value_or(any_peer), static_cast<std::uint32_t>(link.queued)});
  if (const auto* gateway = gateway_at(from))
    x.to_sink = static_cast<std::uint32_t>(gateway->port.queued());
  return x;
}

class looker {
public:
  looker(const ecology_state& all, instant now) : all_(all), now_(now) {}

  report::run_sample look() {
    motes_.reserve(all_.motes.size());
    for (const auto& [address, mote] : all_.motes)
      add(address, mote);
    for (const auto& [island, sink] : all_.sinks)
      if (const auto* state = state_of<sink_state>(sink.handle))
        lost_[island].packets += losses_of(state->sink);
    add_airs();
    report::run_sample x;
    x.at = now_;
    x.islands = named_losses();
    x.motes = std::move(motes_);
    x.places = report::losses_of(*all_.messages);
    for (const auto& [name, peer] : all_.peers) {
      x.peers.push_back(sample_of(peer));
      if (const auto* kernel = state_of<peis_peer_state>(peer.handle))
        add_to(x.peis_lost, packages_lost(*kernel));
    }
    return x;
  }

private:
  void add(const mote_address& address, const supervised_mote& mote) {
    report::mote_sample x;
    x.address = address;
    const auto* const state = state_of<mote_state>(mote.handle);
    x.flat = mote.flat;
    x.alive = !mote.flat && state != nullptr;
    if (const auto* air = state_of<air_state>(mote.arguments->air)) {
      const auto use = air->channel.energy(mote.arguments->radio, now_);
      x.radio_on = use.radio_on;
      x.energy = {use.charges.radio_off, use.charges.radio_listen, use.charges.radio_receive,
                  use.charges.radio_transmit, use.charges.mcu};
      x.used_mah = use.used_mah;
      x.battery_mah = use.battery_mah;
    }
    x.joined = x.alive && (!state->node || state->node->member().joined());
    if (state != nullptr && state->node) {
      if (x.alive) {
        add_route(x, *state->node);
        add_network(x, state->node->packets().router());
      }
      lost_[address.island].packets += losses_of(*state->node);
      const auto& messages = state->node->above().ports().messages.core().counters();
      if (const auto ended = messages.reliable_acked + messages.reliable_failed; ended > 0)
        x.delivery = static_cast<double>(messages.reliable_acked) / static_cast<double>(ended);
    }
    motes_.push_back(std::move(x));
  }

  void add_airs() {
    std::vector<const air_state*> seen; // islands may share one
    for (const auto& [island, air] : all_.airs) {
      const auto* const state = state_of<air_state>(air);
      if (state == nullptr || std::ranges::find(seen, state) != seen.end())
        continue;
      seen.push_back(state);
      const auto radios = state->channel.counts().by_radio();
      for (std::size_t i = 0; i < state->addresses.size(); ++i)
        lost_[state->addresses[i].island].radio += radios[i];
    }
  }

  /// With what lives that have ended have lost.
  std::vector<report::island_sample> named_losses() {
    std::map<island_id, std::map<std::string, report::cause_counts>> all;
    for (const auto& [island, lost] : lost_) {
      auto& named = all[island];
      named["network"] = lost_of(lost.packets);
      const auto radio = report_of(lost.radio);
      named["radio"] = report::really_lost(radio);
      named["mac"] = radio.mac_failed;
    }
    for (const auto& island : all_.report.islands) {
      add_to(all[island.id]["network"], island.network.lost);
      add_to(all[island.id]["serial"], island.serial.lost);
    }
    add_lines(all);
    for (const auto& [who, tally] : all_.messages->tallied()) {
      const bool is_message = who.second == message_kind::message;
      auto& lost = all[who.first.island][is_message ? "messages" : "channels"];
      add_to(lost, report::lost_of(tally));
      lost["in_transit"] += tally.in_transit();
    }
    std::vector<report::island_sample> islands;
    for (auto& [island, lost] : all)
      islands.push_back({island, std::move(lost)});
    return islands;
  }

  /// Of cables, and of both ends of each.
  void add_lines(std::map<island_id, std::map<std::string, report::cause_counts>>& all) const {
    for (const auto& [where, line] : all_.lines)
      if (const auto* cable = state_if<serial_line_state, serial_line_interface>(&line.get()))
        add_to(all[where.first]["serial"], counted(*cable).lost);
    for (const auto& [island, sink] : all_.sinks)
      if (const auto* state = state_of<sink_state>(sink.handle))
        add_to(all[island]["serial"], counted(*state).lost);
    for (const auto& [name, peer] : all_.peers)
      if (const auto* gateway = gateway_at(peer))
        add_to(all[gateway->arguments.config.island]["serial"], counted(*gateway).lost);
  }

  struct losses {
    packet_losses packets;
    radio::radio_counters radio;
  };

  const ecology_state& all_;
  instant now_;
  std::vector<report::mote_sample> motes_;
  std::map<island_id, losses> lost_;
};

} // namespace

namespace {

/// What the motes of an island are judged by.
struct island_view {
  std::optional<island_time> time; ///< of its sink
  std::vector<const gateway_state*> gateways;
};

std::map<island_id, island_view> views_of(const ecology_state& all, instant now) {
  std::map<island_id, island_view> views;
  for (const auto& [island, sink] : all.sinks) {
    const auto* const state = state_of<sink_state>(sink.handle);
    if (state == nullptr)
      continue;
    const auto& clock = state->sink.packets().router().clock();
    auto& view = views[island];
    if (clock.synchronised())
      view.time = clock.at(state->arguments.crystal.own(now));
  }
  for (const auto& [name, peer] : all.peers)
    if (const auto view = peer.island ? views.find(*peer.island) : views.end(); view != views.end())
      if (const auto* gateway = gateway_at(peer))
        view->second.gateways.push_back(gateway);
  std::erase_if(views, [](const auto& x) { return x.second.gateways.empty(); });
  return views;
}

report::mote_look look_of(const ecology_state& all, const mote_address& address,
                          const supervised_mote& mote, const island_view* view, instant now) {
  report::mote_look x;
  const auto* const state = state_of<mote_state>(mote.handle);
  if (mote.flat || state == nullptr || state->flat || !state->node)
    return x;
  const auto& node = *state->node;
  const auto& router = node.packets().router();
  x.runs = true;
  x.moves = !mote.arguments->path.empty();
  x.has_route = router.tree().has_route();
  if (x.has_route)
    x.hops = router.tree().hops();
  if (view == nullptr)
    return x;
  const auto messages = all.messages->of(address, message_kind::message);
  x.messages = messages.sent;
  x.arrived = messages.arrived;
  if (!view->time || !router.clock().synchronised())
    return x;
  const auto own = state->crystal.own(now);
  x.clock_error = std::chrono::abs(router.clock().at(own) - *view->time);
  x.clock_doubt = router.clock().doubt(own);
  return x;
}

} // namespace

report::run_sample look_at(const ecology_state& all, instant now) {
  return looker(all, now).look();
}

void watch_time(ecology_state& all, instant now) {
  const auto views = views_of(all, now);
  for (const auto& [island, sink] : all.sinks)
    if (!views.contains(island)) // its sink or gateway is down
      all.watch.on_cause(island, now);
  for (const auto& [address, mote] : all.motes) {
    if (mote.arguments->stack != config::stack::full)
      continue;
    const auto view = views.find(address.island);
    all.watch.look(address, mote.arguments->name,
                   look_of(all, address, mote, view == views.end() ? nullptr : &view->second, now),
                   now);
  }
}

instant batteries_last_until(const ecology_state& all, instant now) {
  auto first = instant::max();
  for (const auto& [island, air] : all.airs)
    if (const auto* state = state_of<air_state>(air))
      first = std::min(first, state->channel.batteries_last_until());
  for (const auto& each : all.plan)
    if (std::holds_alternative<config::battery_end_fault>(
            all.description.faults[each.index].what) &&
        instant(each.at) + last_words_time >= now)
      first = std::min(first, instant(each.at));
  return first;
}

} // namespace rubicon
