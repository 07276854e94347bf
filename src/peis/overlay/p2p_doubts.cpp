// Links to real kernels that may be dead without either end knowing: after a cut, both wait for
// TCP's next try, which comes ever later. Another link, tried beside, shows at once that the way is
// free again, and then takes the place of the old one.
#include <algorithm>

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

namespace {

constexpr duration beside_gap = 1s; // between two tries for one link

} // namespace

/// Marked neighbours beat, and are given up soon.
bool p2p::can_be_doubted(const connection& x) const {
  return x.open && x.named && !is_marked(x);
}

instant p2p::doubt_begins(const connection& x) const {
  const auto silent = x.last_octets + config_.sign_after + config_.sign_timeout;
  return x.unreported > 0 ? std::min(silent, x.drained + config_.sign_timeout) : silent;
}

bool p2p::is_doubtful(const connection& x, instant now) const {
  return can_be_doubted(x) && doubt_begins(x) <= now;
}

/// When there is something to do about a link: to ask for a sign of life, or to try another.
instant p2p::next_doubt_of(const connection& x) const {
  const auto asks = std::max(x.last_octets, x.sign_asked) + config_.sign_after;
  return std::min(asks, std::max(doubt_begins(x), x.next_beside));
}

void p2p::watch_doubt(const connection& x) {
  if (can_be_doubted(x))
    next_doubt_ = earliest(next_doubt_, next_doubt_of(x));
}

void p2p::tend_doubts(instant now) {
  if (!next_doubt_ || *next_doubt_ > now)
    return;
  next_doubt_.reset();
  std::vector<link_id> doubtful;
  for (auto& [link, x] : connections_) {
    if (!can_be_doubted(x))
      continue;
    if (std::max(x.last_octets, x.sign_asked) + config_.sign_after <= now) {
      x.sign_asked = now;
      tell_host(*x.neighbour, link, lane::high, port::trace, encode(trace_message{{self_.id}}));
    }
    if (std::max(doubt_begins(x), x.next_beside) <= now) {
      x.next_beside = now + beside_gap;
      doubtful.push_back(link);
    }
    watch_doubt(x);
  }
  for (const auto link : doubtful)
    try_beside(connections_.at(link), now);
}

/// Is another link to that host there that may be alive, or asked for?
bool p2p::has_other_hope(const connection& x, instant now) const {
  const auto host = *x.neighbour;
  return std::ranges::any_of(attempts_, [&](const auto& y) { return y.second.host == host; }) ||
         std::ranges::any_of(connections_, [&](const auto& entry) {
           const auto& y = entry.second;
           return y.id != x.id && (y.neighbour == host || y.tried_for == host) &&
                  !is_doubtful(y, now);
         });
}

void p2p::try_beside(const connection& x, instant now) {
  const auto known = hosts_.find(*x.neighbour);
  if (has_other_hope(x, now) || known == hosts_.end())
    return;
  const auto kept = std::ranges::find(standing_, x.id, &standing_address::link);
  if (kept != standing_.end())
    connect(kept->url,
            {x.request_flags, *x.neighbour, static_cast<std::size_t>(kept - standing_.begin()), {}},
            now);
  else
    static_cast<void>(connect_host(known->second.record, connect_request::for_merge, now));
}

/// A neighbour has told its routes over one link: others to it that are in doubt are of no use.
void p2p::end_doubtful_beside(link_id link, instant now) {
  const auto neighbour = connections_.at(link).neighbour;
  std::vector<link_id> dead;
  for (const auto& [other, x] : connections_) {
    if (other != link && neighbour && x.neighbour == neighbour && is_doubtful(x, now))
      dead.push_back(other);
  }
  counters_.links_broken += dead.size();
  for (const auto other : dead)
    close(other, close_cause::replaced, now);
}

bool p2p::has_named_link(peer_id host) const {
  return std::ranges::any_of(connections_, [host](const auto& entry) {
    return entry.second.named && entry.second.neighbour == host;
  });
}

/// A real kernel that we were away from tells its other neighbours of us within 10 s. What we
/// broadcast over it, they hear at once.
void p2p::show_ourselves(connection& to) {
  auto content = std::make_shared<const message_octets>(
      message_octets{encode(host_record_message{self_, false}), {}});
  count_drop(enqueue(to, lane::high,
                     {fresh_header(package_type::broadcast, port::host_record), content, 0}));
}

/// The same, seen from there: a host of our kind speaks over a real kernel, whose routes do not
/// have it yet.
void p2p::hear_beyond(link_id from, const package_header& header, const host_record& record,
                      instant now) {
  const auto& x = connections_.at(from);
  if (header.type != package_type::broadcast || !record.marked || reachable(record.id) ||
      !can_be_doubted(x))
    return;
  const auto hops = std::min(header.hops, config_.metric_limit) * config_.cost_other_host;
  apply(routing_.on_heard(from, record.id, record.magic, static_cast<std::uint8_t>(hops), now),
        now);
}

} // namespace rubicon::peis
