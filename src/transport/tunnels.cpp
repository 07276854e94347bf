#include "transport/tunnels.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

#include "core/account/message_ledger.hpp"

namespace rubicon::transport {

namespace {

/// Of keep-alives so many may be lost, one after the other.
constexpr int silent_periods = 3;

/// Windows are short, and all packets of an island share them: keep-alives take one in so many.
constexpr int windows_per_keep_alive = 4;

/// Of two lives of a node, is `a` the later one?
bool is_later(tunnel_life a, tunnel_life b) {
  const int distance = (a + tunnel_lives - b) % tunnel_lives;
  return distance != 0 && distance <= tunnel_lives / 2;
}

} // namespace

std::string_view to_string(tunnel_end x) {
  switch (x) {
  case tunnel_end::refused:
    return "refused";
  case tunnel_end::unreachable:
    return "unreachable";
  case tunnel_end::closed:
    return "closed";
  case tunnel_end::silent:
    return "silent";
  }
  return "?";
}

/// Lives come round again; numbers then begin elsewhere.
tunnels::tunnels(tunnels_config config)
    : config_(config), life_(static_cast<tunnel_life>(1 + config.incarnation % tunnel_lives)),
      last_number_(static_cast<std::uint16_t>(config.incarnation / tunnel_lives << 8)) {
  assert(config_.connect_wait > 0s && config_.keep_alive > 0s && config_.silence > 0s);
}

std::pair<tunnel_id, tunnels_outputs> tunnels::connect(mote_address destination, instant now) {
  if (destination.island == own_island)
    destination.island = island_;
  if (destination.mote == own_mote)
    destination.mote = config_.self;
  ++counters_.connects;
  const tunnel_id id{++last_id_};
  tunnels_outputs out;
  if (destination.mote == broadcast_mote) {
    ++counters_.unreachable;
    out.emplace_back(tunnel_ended{id, tunnel_end::unreachable});
  } else if (entries_.size() >= config_.tunnels_max) {
    ++counters_.no_room;
    out.emplace_back(tunnel_ended{id, tunnel_end::refused});
  } else {
    const auto is_used = [&](const auto& x) {
      return x.second.opened_here && x.second.number == last_number_;
    };
    do
      ++last_number_;
    while (std::ranges::any_of(entries_, is_used));
    const tunnel added{destination, last_number_, true, 0, now, now, config_.connect_wait};
    entries_.emplace(id, added);
    out.emplace_back(packet(added, kind::connect));
  }
  return {id, std::move(out)};
}

std::optional<tunnels_outputs> tunnels::send(tunnel_id id, byte_view content, instant now) {
  const auto at = entries_.find(id);
  if (at == entries_.end() || at->second.peer_life == 0 || content.size() > tunnel_content_max) {
    ++counters_.not_sent;
    note_loss(loss::channel_closed);
    return std::nullopt;
  }
  ++counters_.sent;
  at->second.sent = now;
  tunnels_outputs out;
  out.emplace_back(packet(at->second, kind::data, content));
  return out;
}

tunnels_outputs tunnels::close(tunnel_id id) {
  return end_here(id, kind::close);
}

tunnels_outputs tunnels::refuse(tunnel_id id) {
  return end_here(id, kind::refuse);
}

tunnels_outputs tunnels::end_here(tunnel_id id, kind what) {
  tunnels_outputs out;
  const auto at = entries_.find(id);
  if (at == entries_.end())
    return out;
  out.emplace_back(packet(at->second, at->second.opened_here ? kind::close : what));
  forget(at);
  return out;
}

packet_out tunnels::packet(const tunnel& x, kind what, byte_view content) const {
  tunnel_message message;
  message.what = what;
  message.from_acceptor = !x.opened_here;
  message.sender = config_.self;
  message.receiver = x.peer.mote;
  message.number = x.number;
  message.opener = x.opened_here ? life_ : x.peer_life;
  message.acceptor = x.opened_here ? x.peer_life : life_;
  message.content = to_bytes(content);
  return {x.peer, encode(message)};
}

/// About a tunnel that is not here: with the name that `x` calls it.
packet_out tunnels::answer(mote_address to, const tunnel_message& x, kind what) const {
  tunnel_message message;
  message.what = what;
  message.from_acceptor = !x.from_acceptor;
  message.sender = config_.self;
  message.receiver = x.sender;
  message.number = x.number;
  message.opener = x.opener;
  message.acceptor = x.what == kind::connect ? life_ : x.acceptor;
  return {to, encode(message)};
}

tunnels_outputs tunnels::on_packet(island_id source_island, byte_view octets, instant now) {
  tunnels_outputs out;
  auto decoded = decode_tunnel_message(octets);
  if (!decoded) {
    ++counters_.malformed;
    note_loss(loss::malformed);
    return out;
  }
  auto& x = *decoded;
  const mote_address from{source_island, x.sender};
  if (x.receiver != config_.self) {
    ++counters_.misdirected;
    note_loss(loss::no_program);
    return out;
  }
  const auto at = find(from, x);
  if (at != entries_.end()) {
    on_open(at, x, out, now);
  } else if (x.what == kind::connect) {
    on_connect(from, x, out, now);
  } else {
    ++counters_.strays;
    note_loss(loss::channel_closed);
    if (x.what != kind::close && x.what != kind::refuse)
      out.emplace_back(answer(from, x, kind::close));
  }
  return out;
}

/// The tunnel that `x` names. A life that its sender did not know is any.
tunnels::entry tunnels::find(mote_address from, const tunnel_message& x) {
  const auto peer_life = x.from_acceptor ? x.acceptor : x.opener;
  const auto own_life = x.from_acceptor ? x.opener : x.acceptor;
  if (own_life != 0 && own_life != life_)
    return entries_.end();
  return std::ranges::find_if(entries_, [&](const auto& item) {
    const tunnel& y = item.second;
    return y.peer == from && y.number == x.number && y.opened_here == x.from_acceptor &&
           (y.peer_life == 0 || y.peer_life == peer_life);
  });
}

/// A tunnel that we do not know, or not any more.
void tunnels::on_connect(mote_address from, const tunnel_message& x, tunnels_outputs& out,
                         instant now) {
  if (is_late(from, x, out)) {
    ++counters_.strays;
    out.emplace_back(answer(from, x, kind::close));
    return;
  }
  if (entries_.size() >= config_.tunnels_max) {
    ++counters_.no_room;
    out.emplace_back(answer(from, x, kind::refuse));
    return;
  }
  ++counters_.accepted;
  const tunnel_id id{++last_id_};
  const tunnel added{from, x.number, false, x.opener, now, now, duration{0}};
  entries_.emplace(id, added);
  out.emplace_back(packet(added, kind::accept));
  out.emplace_back(tunnel_accepted{id, from});
}

/// Does this connect belong to a tunnel that has ended, or to an earlier life of the opener? If it
/// is a later life, those of the earlier ones end now.
bool tunnels::is_late(mote_address from, const tunnel_message& x, tunnels_outputs& out) {
  if (std::ranges::find(ended_, memory{from, x.number, x.opener}) != ended_.end())
    return true;
  for (auto at = entries_.begin(); at != entries_.end();) {
    const auto here = at++;
    const tunnel& y = here->second;
    if (y.peer != from || y.peer_life == 0 || y.peer_life == x.opener)
      continue;
    if (!is_later(x.opener, y.peer_life))
      return true;
    end(here, tunnel_end::closed, out);
  }
  return false;
}

std::optional<tunnels::route> tunnels::route_of(tunnel_id id) const {
  const auto at = entries_.find(id);
  if (at == entries_.end() || !at->second.round_trip)
    return std::nullopt;
  return route{at->second.peer, *at->second.round_trip};
}

void tunnels::on_open(entry at, tunnel_message& x, tunnels_outputs& out, instant now) {
  auto& [id, y] = *at;
  if (x.what == kind::close || x.what == kind::refuse) {
    end(at, x.what == kind::close ? tunnel_end::closed : tunnel_end::refused, out);
    return;
  }
  // Since the first connect, or since the accept: an opener goes on at once.
  if (!y.round_trip && x.what != kind::connect)
    y.round_trip = now - y.last_received;
  y.last_received = now;
  if (y.peer_life == 0) { // whatever an acceptor says, it has accepted
    y.peer_life = x.acceptor;
    ++counters_.connected;
    out.emplace_back(tunnel_connected{id});
  }
  if (x.what == kind::connect) { // our accept may have been lost
    y.sent = now;
    out.emplace_back(packet(y, kind::accept));
  } else if (x.what == kind::data) {
    ++counters_.received;
    out.emplace_back(tunnel_received{id, std::move(x.content)});
  }
}

void tunnels::forget(entry x) {
  if (!x->second.opened_here && config_.remembered_max > 0) {
    if (ended_.size() >= config_.remembered_max)
      ended_.erase(ended_.begin());
    ended_.push_back({x->second.peer, x->second.number, x->second.peer_life});
  }
  entries_.erase(x);
}

void tunnels::end(entry x, tunnel_end why, tunnels_outputs& out) {
  switch (why) {
  case tunnel_end::refused:
    ++counters_.refused;
    break;
  case tunnel_end::unreachable:
    ++counters_.unreachable;
    break;
  case tunnel_end::closed:
    ++counters_.closed;
    break;
  case tunnel_end::silent:
    ++counters_.silent;
    break;
  }
  out.emplace_back(tunnel_ended{x->first, why});
  forget(x);
}

/// That of both ends' islands. One's own is not counted twice for a tunnel within it.
answer_slack tunnels::slack_to(mote_address peer) const {
  auto sum = slack_of(config_.slacks, peer);
  if (peer.island == island_ && peer.mote != no_mote)
    return sum;
  const auto here = slack_of(config_.slacks, {island_, config_.self});
  sum.there_and_back += here.there_and_back;
  sum.period = std::max(sum.period, here.period);
  return sum;
}

duration tunnels::keep_alive_of(const tunnel& x) const {
  return std::max(config_.keep_alive, windows_per_keep_alive * slack_to(x.peer).period);
}

/// Until nothing received means that the other end is gone.
duration tunnels::patience_with(const tunnel& x) const {
  const auto slack = slack_to(x.peer).there_and_back;
  if (x.peer_life == 0)
    return config_.connect_timeout + 2 * slack;
  return config_.silence + silent_periods * (keep_alive_of(x) - config_.keep_alive) + slack;
}

instant tunnels::due(const tunnel& x) const {
  const auto next = x.peer_life == 0 ? x.wait + slack_to(x.peer).there_and_back : keep_alive_of(x);
  return std::min(x.sent + next, x.last_received + patience_with(x));
}

std::optional<instant> tunnels::deadline() const {
  std::optional<instant> next;
  for (const auto& [id, x] : entries_)
    next = earliest(next, due(x));
  return next;
}

tunnels_outputs tunnels::on_time(instant now) {
  tunnels_outputs out;
  for (auto at = entries_.begin(); at != entries_.end();) {
    const auto here = at++;
    if (due(here->second) <= now)
      on_due(here, out, now);
  }
  return out;
}

/// An end that gives up sends a close, which may still reach the other one.
void tunnels::on_due(entry at, tunnels_outputs& out, instant now) {
  auto& x = at->second;
  const bool is_open = x.peer_life != 0;
  if (now >= x.last_received + patience_with(x)) {
    out.emplace_back(packet(x, kind::close));
    end(at, is_open ? tunnel_end::silent : tunnel_end::unreachable, out);
    return;
  }
  x.sent = now;
  if (is_open) {
    ++counters_.keep_alives;
    out.emplace_back(packet(x, kind::keep_alive));
  } else {
    ++counters_.retries;
    x.wait = std::min(2 * x.wait, config_.connect_wait_max);
    out.emplace_back(packet(x, kind::connect));
  }
}

std::optional<mote_address> tunnels::peer_of(tunnel_id id) const {
  const auto at = entries_.find(id);
  return at == entries_.end() ? std::nullopt : std::optional(at->second.peer);
}

} // namespace rubicon::transport
