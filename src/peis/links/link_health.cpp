#include "peis/links/link_health.hpp"

#include <algorithm>

namespace rubicon::peis {

namespace {

constexpr duration beside_gap = 1s; // between two tries for one link

} // namespace

bool link_health::is_marked(const connection& x) const {
  return x.neighbour && hosts_.is_marked(*x.neighbour);
}

duration link_health::patience(const connection& x) const {
  if (!x.open)
    return own_.config.handshake_timeout;
  if (x.in.octets == 0)
    return own_.config.greeting_timeout;
  return x.signs.beat && is_marked(x) ? own_.config.heartbeat_timeout : own_.config.link_timeout;
}

/// A link also falls silent when what it was given does not leave.
instant link_health::silence_deadline(const connection& x) const {
  return std::min(x.in.last_package + patience(x), drain_deadline(x));
}

instant link_health::drain_deadline(const connection& x) const {
  return x.out.unreported > 0 ? x.out.drained + own_.config.link_timeout : instant::max();
}

void link_health::watch_silence(const connection& x) {
  next_silence_check_ = earliest(next_silence_check_, silence_deadline(x));
}

std::vector<std::pair<link_id, close_cause>> link_health::take_silent(instant now) {
  if (!next_silence_check_ || now < *next_silence_check_)
    return {};
  std::vector<std::pair<link_id, close_cause>> silent;
  next_silence_check_.reset();
  for (const auto& [link, x] : links_.all()) {
    const bool waits = x.open && x.in.waits; // what has come is still to be handled
    if (waits && drain_deadline(x) > now)
      next_silence_check_ = earliest(next_silence_check_, now + own_.config.heartbeat_timeout);
    else if (waits || silence_deadline(x) <= now)
      silent.emplace_back(link, x.open ? close_cause::silent : close_cause::handshake_silent);
    else
      watch_silence(x);
  }
  return silent;
}

bool link_health::can_be_suspected(const connection& x) const {
  return x.open && x.named && !is_marked(x);
}

instant link_health::suspicion_begins(const connection& x) const {
  const auto silent = x.in.last_octets + own_.config.sign_after + own_.config.sign_timeout;
  return x.out.unreported > 0 ? std::min(silent, x.out.drained + own_.config.sign_timeout) : silent;
}

bool link_health::is_suspect(const connection& x, instant now) const {
  return can_be_suspected(x) && suspicion_begins(x) <= now;
}

instant link_health::asks_at(const connection& x) const {
  return std::max(x.in.last_octets, x.signs.asked) + own_.config.sign_after;
}

/// When there is something to do about a link: to ask for a sign of life, or to try another.
instant link_health::next_suspicion_of(const connection& x) const {
  return std::min(asks_at(x), std::max(suspicion_begins(x), x.signs.next_beside));
}

void link_health::watch_suspicion(const connection& x) {
  if (can_be_suspected(x))
    next_suspicion_ = earliest(next_suspicion_, next_suspicion_of(x));
}

link_health::suspects link_health::take_suspects(instant now) {
  if (!next_suspicion_ || *next_suspicion_ > now)
    return {};
  next_suspicion_.reset();
  suspects due;
  for (auto& [link, x] : links_.all()) {
    if (!can_be_suspected(x))
      continue;
    if (asks_at(x) <= now) {
      x.signs.asked = now;
      due.ask.push_back(link);
    }
    if (std::max(suspicion_begins(x), x.signs.next_beside) <= now) {
      x.signs.next_beside = now + beside_gap;
      due.beside.push_back(link);
    }
    watch_suspicion(x);
  }
  return due;
}

std::optional<instant> link_health::deadline() const {
  return own_.left ? next_silence_check_ : earliest(next_silence_check_, next_suspicion_);
}

} // namespace rubicon::peis
