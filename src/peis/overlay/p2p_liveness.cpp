// Signs of life, proof of ways, traces, the shared clock (A-76, KH-05, peis-wire.md 12 and 13).
#include <algorithm>
#include <utility>

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

namespace {

constexpr duration trace_timeout = 5s;
constexpr int probe_burial = 30; // seconds that disproved news are ignored
// The same, of a host of another kind: others of that kind go on counting (peis-wire.md 9.4).
constexpr int original_burial = 120;
constexpr int beats_skipped = 10; // while there is traffic, one heartbeat in so many periods
constexpr int way_smoothing = 16;

} // namespace

bool p2p::is_marked(const connection& x) const {
  if (!x.neighbour)
    return false;
  const auto known = hosts_.find(*x.neighbour);
  return known != hosts_.end() && known->second.record.marked;
}

instant p2p::next_beat_of(const connection& x) const {
  return std::min(x.last_written + config_.heartbeat_period,
                  x.beat_sent + beats_skipped * config_.heartbeat_period);
}

void p2p::expect_beat(const connection& x) {
  if (x.open && is_marked(x))
    next_beat_ = earliest(next_beat_, next_beat_of(x));
}

void p2p::beat(instant now) {
  if (!next_beat_ || *next_beat_ > now)
    return;
  next_beat_.reset();
  for (auto& [link, x] : connections_) {
    if (!x.open || !is_marked(x))
      continue;
    if (next_beat_of(x) <= now) {
      send_beat(x, now);
      x.last_written = now; // it leaves with this flush, or the link is stuck
    }
    next_beat_ = earliest(next_beat_, next_beat_of(x));
  }
}

void p2p::send_beat(connection& x, instant now) {
  heartbeat message{now, {}, {}};
  if (x.beat) {
    message.echoed = x.beat->sent;
    message.held = now - x.beat_heard;
  }
  tell_neighbour(x, port::heartbeat, encode(message));
  ++counters_.heartbeats_sent;
  x.beat_sent = now;
}

void p2p::on_heartbeat(connection& x, byte_view data, instant now) {
  const auto message = decode_heartbeat(data);
  if (!message) {
    ++counters_.malformed;
    return;
  }
  if (message->echoed != instant{}) {
    const auto way = std::max<duration>((now - message->echoed - message->held) / 2, 0s);
    // The least is the least disturbed; it may grow slowly if the way has really changed.
    x.one_way =
        !x.one_way || way < *x.one_way ? way : *x.one_way + (way - *x.one_way) / way_smoothing;
  }
  const bool first = !x.beat;
  x.beat = *message;
  x.beat_heard = now;
  if (first && is_marked(x)) {
    send_beat(x, now); // both ends know the round trip at once
    watch_silence(x);
  }
}

void p2p::probe_unsound(instant now) {
  for (const auto host : routing_.take_unsound())
    probes_.begin(host, now);
}

void p2p::handle(const probe_host& x, instant /*now*/) {
  send_trace(x.host);
}

void p2p::handle(const way_disproved& x, instant now) {
  const auto* record = find_host(x.host);
  const bool marked = record != nullptr && record->marked;
  const std::chrono::seconds burial(marked ? probe_burial : original_burial);
  const auto changes = routing_.unanswered(x.host, now, now + burial);
  counters_.ways_disproved += changes.size();
  apply(changes, now);
}

/// A marked host to which no route is left is not waited for.
void p2p::check_losses(instant now) {
  const auto first = routing_.first_loss();
  if (!first || *first + config_.lost_timeout > now)
    return;
  for (const auto host : routing_.lost_since(now - config_.lost_timeout))
    delete_host(host, dead_host_message::reason::route, now);
}

void p2p::send_trace(peer_id destination) {
  const auto way = way_to(destination);
  if (!way)
    return;
  tell_host(destination, *way, lane::high, port::trace, encode(trace_message{{self_.id}}));
}

void p2p::trace(peer_id destination, request_id id, instant now) {
  if (destination == self_.id || !reachable(destination) || left_) {
    const bool self = destination == self_.id;
    events_.push_back(
        traced{id, destination, self ? std::vector{self_.id} : std::vector<peer_id>()});
    return;
  }
  traces_.push_back({destination, id, now + trace_timeout});
  send_trace(destination);
}

void p2p::check_traces(instant now) {
  std::erase_if(traces_, [&](const open_trace& x) {
    if (x.deadline > now)
      return false;
    events_.push_back(traced{x.id, x.destination, {}});
    return true;
  });
}

/// Everybody who sees a trace adds itself. One that passes goes on as a package of its own; the
/// destination sends it back as a reply.
void p2p::on_trace(const package_header& header, byte_view data) {
  auto message = decode_trace(data);
  if (!message) {
    ++counters_.malformed;
    return;
  }
  const bool mine = header.destination == self_.id;
  if (mine && header.port == port::trace_reply) {
    message->hosts.push_back(self_.id);
    // The message names no question: it answers all that were asked about its source.
    std::erase_if(traces_, [&](const open_trace& x) {
      if (x.destination != header.source)
        return false;
      events_.push_back(traced{x.id, x.destination, message->hosts});
      return true;
    });
    return;
  }
  const auto destination = mine ? header.source : header.destination;
  const auto way = any_route_to(destination);
  if (!way || message->hosts.size() >= trace_hosts_max) {
    ++(way ? counters_.hops : counters_.no_route);
    return;
  }
  message->hosts.push_back(self_.id);
  auto content = std::make_shared<const message_octets>(message_octets{encode(*message), {}});
  auto next = fresh_header(package_type::direct, mine ? port::trace_reply : header.port);
  next.destination = destination;
  if (!mine) {
    next.source = header.source;
    next.hops = 2;
  }
  count_drop(enqueue(connections_.at(*way), lane::high, {next, std::move(content), 0}));
}

/// Is the time in this broadcast's last octets what the way here took?
bool p2p::measures_way(const package_header& header) const {
  const auto* record = find_host(header.source);
  return record != nullptr && record->marked;
}

void p2p::on_clock(link_id from, const package_header& header, byte_view data, instant now) {
  const auto message = decode_clock(data, clock_.at(now));
  if (!message) {
    ++counters_.malformed;
    return;
  }
  const bool marked = measures_way(header);
  const auto last_link = connections_.at(from).one_way.value_or(0s);
  clock_.on_message(*message, header.source, marked ? message->in_flight + last_link : 0s, marked,
                    now);
}

/// A clock broadcast goes on with the time that its last link took added. What follows the message
/// goes on as it is.
bytes p2p::clock_after(link_id from, byte_view data) const {
  auto octets = to_bytes(data);
  if (auto message = decode_clock(data, clock_.offset())) {
    message->in_flight += connections_.at(from).one_way.value_or(0s);
    std::ranges::copy(encode(*message), octets.begin());
  }
  return octets;
}

void p2p::tell_time(instant now) {
  if (const auto message = clock_.on_time(now); message && !connections_.empty())
    static_cast<void>(broadcast(port::clock, encode(*message)));
}

void p2p::watch_life(instant now) {
  beat(now);
  settle(probes_.on_time(now), now);
  check_traces(now);
  if (left_)
    return;
  check_losses(now);
  tell_time(now);
}

std::optional<instant> p2p::life_deadline() const {
  auto next = earliest(next_beat_, probes_.deadline());
  for (const auto& x : traces_)
    next = earliest(next, x.deadline);
  if (left_)
    return next;
  if (const auto first = routing_.first_loss())
    next = earliest(next, *first + config_.lost_timeout);
  return earliest(next, clock_.deadline());
}

} // namespace rubicon::peis
