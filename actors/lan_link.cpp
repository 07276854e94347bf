// A peer's end of its simulated links.
#include <algorithm>
#include <charconv>
#include <utility>

#include "actors/peis_peer.hpp"
#include "peis/link.hpp"
#include "peis/link_url.hpp"
#include "peis/package.hpp"
#include "peis/package_walk.hpp"

namespace rubicon {

namespace {

/// Whom `inproc://id` names.
std::optional<peer_id> inproc_peer(const peis::link_url& url) {
  std::int32_t id = 0;
  const auto end = url.host.data() + url.host.size();
  const auto [stop, error] = std::from_chars(url.host.data(), end, id);
  if (url.medium != peis::link_url::scheme::inproc || error != std::errc{} || stop != end)
    return std::nullopt;
  return peer_id{id};
}

/// Whom `bt://address;port` names.
std::optional<peis::bluetooth_address> bluetooth_device(const peis::link_url& url) {
  if (url.medium != peis::link_url::scheme::bluetooth)
    return std::nullopt;
  const auto address = peis::parse_bluetooth_address(url.host);
  return address ? std::optional(*address) : std::nullopt;
}

/// The packages of `all` that are not in `rest`, which is `all` without some of them.
bytes lost_packages(byte_view all, byte_view rest) {
  bytes lost;
  while (!all.empty()) {
    const auto header = peis::decode_header(all);
    const auto size =
        header ? std::min(all.size(), peis::header_size + header->length) : all.size();
    const auto package = all.first(size);
    if (rest.size() >= size && std::ranges::equal(package, rest.first(size)))
      rest = rest.subspan(size);
    else
      lost.insert(lost.end(), package.begin(), package.end());
    all = all.subspan(size);
  }
  return lost;
}

/// How long a simulated link needs to send so many octets.
duration sending_time(std::uint64_t rate_bps, std::size_t octets) {
  if (rate_bps == 0)
    return 0s;
  return duration(
      static_cast<std::int64_t>(8e9 * static_cast<double>(octets) / static_cast<double>(rate_bps)));
}

} // namespace

void ask_for_link(peer_pointer self, const peis::connect_to& x) {
  const auto url = peis::parse_link_url(x.url);
  const auto& arguments = self->state.arguments;
  const auto peer = url ? inproc_peer(*url) : std::nullopt;
  const auto device = url ? bluetooth_device(*url) : std::nullopt;
  if (peer && arguments.lan)
    self->send(arguments.lan, lan_connect{arguments.station, x.attempt.value, *peer});
  else if (device && arguments.bluetooth)
    self->send(arguments.bluetooth,
               bluetooth_connect{arguments.station, x.attempt.value, *device, url->port});
  else if (!peer && self->state.real != nullptr)
    self->state.real->links().carry_out(x);
  else
    self->send(self, attempt_failed{x.attempt.value});
}

void transmit(peer_pointer self, peis::link_id id, payload octets) {
  auto& state = self->state;
  const auto found = state.links.find(id);
  if (found == state.links.end())
    return;
  auto& link = found->second;
  const auto& network = state.arguments.network;
  link.free_at = std::max(link.free_at, now(self)) + sending_time(link.rate_bps, octets.size());
  if (state.arguments.config.network.link_window > 0)
    self->scheduled_send(self, caf::actor_clock::time_point(link.free_at.time_since_epoch()),
                         link_sent{id.value, octets.size()});
  const bool begins_with_request = std::exchange(link.request_is_next, false);
  if (link.condition.cut) {
    state.octets_cut += octets.size();
    self->remark("link_cut", id.value, [&] { return to_bytes(octets.view()); });
    return;
  }
  if (link.condition.loss > 0) {
    auto rest = peis::without_lost_packages(octets.view(),
                                            begins_with_request ? peis::connect_request_size : 0,
                                            [&] { return state.rng.chance(link.condition.loss); });
    state.packages_lost += rest.lost;
    const auto request =
        std::min(begins_with_request ? peis::connect_request_size : std::size_t{0}, octets.size());
    if (rest.lost > 0)
      self->remark("link_lost", id.value, [&] {
        return lost_packages(octets.view().subspan(request),
                             byte_view(rest.octets).subspan(request));
      });
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
