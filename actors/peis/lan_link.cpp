// A peer's end of its simulated links.
#include <algorithm>
#include <utility>

#include "actors/messages/links.hpp"
#include "actors/peis/peis_peer.hpp"
#include "peis/wire/link_url.hpp"
#include "peis/wire/package.hpp"

namespace rubicon {

void ask_for_link(peer_pointer self, const peis::connect_to& x) {
  const auto url = peis::parse_link_url(x.url);
  const auto& arguments = self->state.arguments;
  const auto peer = url ? peis::inproc_peer(*url) : std::nullopt;
  const auto device = url ? peis::bluetooth_device(*url) : std::nullopt;
  if (peer && arguments.lan)
    self->send(arguments.lan, lan_connect{arguments.station, x.attempt.value, *peer});
  else if (device && arguments.bluetooth)
    self->send(arguments.bluetooth,
               bluetooth_connect{arguments.station, x.attempt.value, *device, url->port});
  else if (!peer && self->state.real != nullptr)
    self->state.real->carry_out(x);
  else
    self->send(self, attempt_failed{x.attempt.value});
}

namespace {

void note_packages_lost(message_ledger& ledger, byte_view octets) {
  while (const auto header = peis::decode_header(octets)) {
    ledger.package_lost(peis::name_of(*header));
    octets = octets.subspan(std::min(octets.size(), peis::header_size + header->length));
  }
}

struct carrier {
  peer_pointer self;
  peis::link_id id;
  const link_end_actor& other;

  void operator()(const peis::octets_leave& x) const {
    if (self->state.arguments.config.network.link_window > 0)
      self->scheduled_send(self, x.at, link_sent{id.value, x.octets});
  }
  void operator()(peis::octets_arrive& x) const {
    self->scheduled_send(other, x.at, link_octets{id.value, std::move(x.octets)});
  }
  void operator()(peis::packages_lost& x) const {
    self->state.packages_lost += x.count;
    note_packages_lost(*self->ledger(), x.octets);
    self->remark("link_lost", id.value, [&] { return std::move(x.octets); });
  }
  void operator()(const peis::octets_cut& x) const {
    self->remark("link_cut", id.value, [&] { return to_bytes(x.octets.view()); });
  }
};

} // namespace

void transmit(peer_pointer self, peis::link_id id, payload octets) {
  const auto found = self->state.links.find(id);
  if (found == self->state.links.end())
    return;
  auto& [other, line] = found->second;
  for (auto& output : line.send(std::move(octets), now(self), self->state.rng))
    std::visit(carrier{self, id, other}, output);
}

void notify_closed(peer_pointer self, peis::link_id id, const peis_peer_state::link_end& link) {
  if (const auto at = link.line.close(now(self)))
    self->scheduled_send(link.other, *at, link_closed{id.value});
}

} // namespace rubicon
