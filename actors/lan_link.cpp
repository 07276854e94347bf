// A peer's end of its links over the simulated network.
#include <algorithm>
#include <utility>

#include "actors/peis_peer.hpp"
#include "peis/link.hpp"
#include "peis/package_walk.hpp"

namespace rubicon {

namespace {

/// How long a simulated link needs to send so many octets.
duration sending_time(const config::peis_description& network, std::size_t octets) {
  if (network.bandwidth_bps == 0)
    return 0s;
  return duration(static_cast<std::int64_t>(8e9 * static_cast<double>(octets) /
                                            static_cast<double>(network.bandwidth_bps)));
}

} // namespace

void transmit(peer_pointer self, peis::link_id id, payload octets) {
  auto& state = self->state;
  const auto found = state.links.find(id);
  if (found == state.links.end())
    return;
  auto& link = found->second;
  const auto& network = state.arguments.network;
  link.free_at = std::max(link.free_at, now(self)) + sending_time(network, octets.size());
  if (state.arguments.config.network.link_window > 0)
    self->scheduled_send(self, caf::actor_clock::time_point(link.free_at.time_since_epoch()),
                         link_sent{id.value, octets.size()});
  const bool begins_with_request = std::exchange(link.request_is_next, false);
  if (link.condition.cut) {
    state.octets_cut += octets.size();
    return;
  }
  if (link.condition.loss > 0) {
    auto rest = peis::without_lost_packages(octets.view(),
                                            begins_with_request ? peis::connect_request_size : 0,
                                            [&] { return state.dice.chance(link.condition.loss); });
    state.packages_lost += rest.lost;
    octets = payload(std::move(rest.octets));
  }
  if (!octets.empty())
    self->scheduled_send(
        link.other, caf::actor_clock::time_point((link.free_at + network.delay).time_since_epoch()),
        link_octets{id.value, std::move(octets)});
}

void tell_closed(peer_pointer self, peis::link_id id, const peis_peer_state::link_end& link) {
  if (link.condition.cut)
    return;
  const auto at = std::max(link.free_at, now(self)) + self->state.arguments.network.delay;
  self->scheduled_send(link.other, caf::actor_clock::time_point(at.time_since_epoch()),
                       link_closed{id.value});
}

} // namespace rubicon
