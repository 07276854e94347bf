#include "peis/p2p/link_greeting.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace rubicon::peis {

namespace {

constexpr std::size_t referrals = 8;

} // namespace

std::optional<close_cause> link_greeting::why_no_link(bool late, link_role role) const {
  if (on_.own.left)
    return close_cause::host_left;
  if (on_.rivalry.is_away())
    return close_cause::own_id;
  if (late)
    return close_cause::unneeded;
  if (role == link_role::initiator && on_.links.open() >= on_.own.config.links_max)
    return close_cause::too_many_links;
  return std::nullopt;
}

bool link_greeting::open(link_id link, link_role role, std::optional<attempt_id> made,
                         const occasion& x) {
  if (on_.links.contains(link))
    return false;
  auto& own = on_.own;
  const auto asked = made ? on_.dials.take(*made) : std::nullopt;
  if (const auto why = why_no_link(made && !asked, role)) {
    ++own.counters.links_refused;
    x.out.push_back(close_link{link, *why});
    return false;
  }
  if (on_.links.size() - on_.links.open() >= own.config.greetings_max)
    evict_greeting(x);
  ++own.counters.links_opened;
  auto& added = on_.links.add(link, x.now);
  if (asked) {
    added.tried_for = asked->host;
    added.tried_here = asked->loopback;
    on_.dials.on_opened(*asked, link);
  }
  if (role == link_role::initiator) {
    added.open = true;
    added.request_flags =
        asked ? asked->flags : connect_request::all_broadcasts | connect_request::for_merge;
    added.out.preamble = encode(
        connect_request{protocol_version, own.self.id, added.request_flags, own.config.network});
    greet(added, x);
  }
  on_.health.watch_silence(added);
  return true;
}

std::optional<close_cause>
link_greeting::why_refused(const result<connect_request>& request) const {
  const auto& own = on_.own;
  if (!request)
    return close_cause::bad_stream;
  if (request->version != protocol_version)
    return close_cause::wrong_version;
  if (request->network != own.config.network)
    return close_cause::wrong_network;
  if (request->id == own.self.id)
    return close_cause::own_id;
  if (request->id.value <= 0)
    return close_cause::bad_id;
  const auto* known = on_.hosts.find(request->id);
  if (own.config.connections.leaf && known != nullptr && !on_.hosts.is_here(known->record))
    return close_cause::leaf;
  return std::nullopt;
}

void link_greeting::accept(connection& from, byte_view request, const occasion& x) {
  auto& counters = on_.own.counters;
  const auto decoded = decode_connect_request(request);
  auto why = why_refused(decoded);
  if (!why && !on_.matches.has_room_for(*decoded, x)) {
    why = close_cause::too_many_links;
    ++counters.newcomers_referred;
    refer_elsewhere(from, x);
  }
  if (why) {
    ++counters.links_refused;
    if (*why == close_cause::own_id)
      refuse_own_id(from, x);
    on_.closer.close(from.id, *why, x);
    return;
  }
  from.request_flags = decoded->flags;
  from.open = true;
  from.asked_at = x.now;
  from.in.last_package = x.now;
  bind(from, decoded->id, x);
  greet(from, x);
}

void link_greeting::bind(connection& x, peer_id neighbour, const occasion& at) {
  on_.links.bind(x, neighbour);
  on_.beats.expect(x);
  on_.health.watch_suspicion(x);
  on_.presence.welcome(neighbour, at);
}

/// Our record, our record again for all if this is our first contact, our routes
/// (peis-wire.md 3.3). Where many have announced themselves, all know us by our announcements.
void link_greeting::greet(connection& to, const occasion& x) {
  auto& own = on_.own;
  const auto content = std::make_shared<const message_octets>(
      message_octets{encode(host_record_message{own.self, false}), {}});
  static_cast<void>(on_.sender.enqueue(
      to, lane::control, {own.fresh_header(package_type::link, port::host_record), content, 0},
      x.origin));
  const bool announced = own.config.connections.announces && on_.hosts.all().size() >= hosts_many;
  if (on_.routes.routes().routes().empty() && !announced)
    on_.sender.flood(own.fresh_header(package_type::broadcast, port::host_record), content, {},
                     x.origin);
  on_.routes.routes().next_seqno();
  on_.exchange.send_to(to, x.origin);
}

/// There is no room for this peer: it is sent who we are and whom else it may ask (TCP-07).
void link_greeting::refer_elsewhere(connection& to, const occasion& x) {
  std::vector<const host_record*> known{&on_.own.self};
  for (const auto& [id, each] : on_.hosts.all()) {
    if (on_.routes.reachable(id) && !each.record.addresses.empty())
      known.push_back(&each.record);
  }
  for (std::size_t i = 1; i < known.size() && i <= referrals; ++i)
    std::swap(known[i], known[i + on_.own.rng.below(known.size() - i)]);
  known.resize(std::min(known.size(), referrals + 1));
  for (const auto* record : known)
    on_.sender.send_to_neighbour(to, port::host_record, encode(host_record_message{*record, true}),
                                 x.origin);
  to.open = true;
  static_cast<void>(on_.writer.write(to, x.now, x.out));
}

/// A peer that asks for a link in our own name is sent whose it is.
void link_greeting::refuse_own_id(connection& to, const occasion& x) {
  on_.sender.send_to_neighbour(to, port::host_record,
                               encode(host_record_message{on_.own.self, false}), x.origin);
  to.open = true;
  static_cast<void>(on_.writer.write(to, x.now, x.out));
}

/// The link that has waited longest for its request.
void link_greeting::evict_greeting(const occasion& x) {
  const connection* oldest = nullptr;
  for (const auto& [link, each] : on_.links.all()) {
    if (!each.open && (oldest == nullptr || each.opened < oldest->opened))
      oldest = &each;
  }
  if (oldest == nullptr)
    return;
  ++on_.own.counters.greetings_evicted;
  ++on_.own.counters.links_refused;
  on_.closer.close(oldest->id, close_cause::handshake_silent, x);
}

} // namespace rubicon::peis
