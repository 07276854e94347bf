#include "peis/udp/udp_port.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

namespace {

using step = udp_handshake::step;

constexpr std::uint16_t room_min = 8;
constexpr std::string_view no_answer = "no answer";
constexpr std::string_view refused = "refused";
constexpr std::string_view ended_there = "closed by the other side";
constexpr std::string_view silent = "no data from the other side";

} // namespace

// What the owner wants.

void udp_port::connect(attempt_id attempt, const udp_address& to, duration timeout, instant now) {
  attempts_[cookies_.next_token()] = {attempt,      to, std::nullopt, now, config_.hello_retry,
                                      now + timeout};
  on_time(now);
}

void udp_port::send(udp_token session, payload octets) {
  const auto found = sessions_.find(session);
  if (found != sessions_.end() && !found->second.closes_until)
    found->second.session.send(std::move(octets));
}

void udp_port::read(udp_token session, bool wanted) {
  const auto found = sessions_.find(session);
  if (found != sessions_.end())
    found->second.wanted = wanted;
}

void udp_port::close(udp_token session, instant now) {
  const auto found = sessions_.find(session);
  if (found == sessions_.end())
    return;
  if (found->second.session.unacknowledged() == 0)
    reset(session);
  else
    found->second.closes_until = now + config_.drain_max;
}

void udp_port::reset(udp_token session) {
  const auto found = sessions_.find(session);
  if (found == sessions_.end())
    return;
  answer(found->second.session.other(), {step::gone, 0, session, 0});
  forget(session);
}

// What comes.

void udp_port::on_datagram(const udp_address& from, byte_view octets, instant now) {
  ++counters_.received;
  const auto x = decode_udp_datagram(octets);
  if (!x)
    ++counters_.malformed;
  else if (const auto* segment = std::get_if<udp_segment>(&*x))
    on_segment(from, *segment, now);
  else
    on_handshake(from, std::get<udp_handshake>(*x), now);
}

void udp_port::on_handshake(const udp_address& from, const udp_handshake& x, instant now) {
  switch (x.kind) {
  case step::hello:
    on_hello(from, x.token, now);
    return;
  case step::cookie:
    on_cookie(from, x, now);
    return;
  case step::open:
    on_open(from, x, now);
    return;
  case step::opened:
    if (!complete(from, x.token, x.room, now) && !sessions_.contains(x.token))
      ++counters_.unknown;
    return;
  case step::gone:
    on_gone(from, x.token);
    return;
  }
}

bool udp_port::accepts_from(const udp_address& from) {
  const auto& all = config_.networks;
  const bool is_listed = all.empty() || std::ranges::any_of(all, [&](const auto& each) {
                           return each.contains(from.ip);
                         });
  if (!config_.accepts || !is_listed)
    ++counters_.foreign;
  return config_.accepts && is_listed;
}

/// Nothing is kept of who asks, and the answer is as long as the question.
void udp_port::on_hello(const udp_address& from, udp_token token, instant now) {
  if (accepts_from(from))
    answer_stranger(from, {step::cookie, 0, token, cookies_.cookie(from, token, now)}, now);
}

void udp_port::on_open(const udp_address& from, const udp_handshake& x, instant now) {
  if (!accepts_from(from))
    return;
  if (!cookies_.is_good(x.cookie, from, x.token, now)) {
    ++counters_.bad_cookies;
    return;
  }
  const auto found = sessions_.find(x.token);
  const bool is_there = found != sessions_.end() && found->second.session.other() == from;
  if (found == sessions_.end() && sessions_.size() < config_.sessions_max &&
      std::ranges::find(ended_, x.token) == ended_.end()) {
    begin_session(from, x.token, x.room, std::nullopt, now);
  } else if (!is_there) {
    ++counters_.refused;
    answer_stranger(from, {step::gone, 0, x.token, 0}, now);
    return;
  }
  answer(from, {step::opened, room_of_each(), x.token, 0});
}

/// May come from another address of that computer: the name of the session shows who it is.
void udp_port::on_cookie(const udp_address& from, const udp_handshake& x, instant now) {
  const auto found = attempts_.find(x.token);
  if (found == attempts_.end()) {
    ++counters_.unknown;
    return;
  }
  auto& attempt = found->second;
  attempt.to = from;
  attempt.cookie = x.cookie;
  attempt.pause = config_.hello_retry;
  attempt.next = now;
  on_time(now);
}

bool udp_port::complete(const udp_address& from, udp_token token, std::uint16_t room, instant now) {
  const auto found = attempts_.find(token);
  if (found == attempts_.end() || found->second.to != from || !found->second.cookie)
    return false;
  const auto id = found->second.id;
  attempts_.erase(found);
  begin_session(from, token, room, id, now);
  return true;
}

void udp_port::on_gone(const udp_address& from, udp_token token) {
  if (const auto x = attempts_.find(token); x != attempts_.end() && x->second.to == from) {
    events_.push_back(udp_refused{x->second.id, refused});
    attempts_.erase(x);
  } else if (const auto y = sessions_.find(token);
             y != sessions_.end() && y->second.session.other() == from) {
    end_session(token, ended_there);
  } else {
    ++counters_.unknown;
  }
}

void udp_port::on_segment(const udp_address& from, const udp_segment& x, instant now) {
  complete(from, x.token, x.room, now); // its `opened` was lost, or is late
  const auto found = sessions_.find(x.token);
  if (found == sessions_.end() || found->second.session.other() != from) {
    ++counters_.unknown;
    if (found == sessions_.end())
      answer_stranger(from, {step::gone, 0, x.token, 0}, now);
    return;
  }
  found->second.session.on_segment(x, now, counters_);
}

// Sessions.

void udp_port::begin_session(const udp_address& other, udp_token token, std::uint16_t room,
                             std::optional<attempt_id> attempt, instant now) {
  auto& x = sessions_[token];
  x.session = udp_session(token, other, config_.session, now);
  x.session.set_room(std::max(room, room_min));
  events_.push_back(udp_opened{token, attempt, other});
}

void udp_port::end_session(udp_token token, std::string_view why) {
  const auto found = sessions_.find(token);
  if (!found->second.closes_until) {
    if (found->second.session.has_received())
      events_.push_back(udp_received{token, found->second.session.take_received()});
    events_.push_back(udp_closed{token, why});
  }
  forget(token);
}

void udp_port::forget(udp_token token) {
  sessions_.erase(token);
  ended_.push_back(token);
  if (ended_.size() > config_.ended_max)
    ended_.pop_front();
}

/// Our socket holds what all of them send.
std::uint16_t udp_port::room_of_each() const {
  const auto share = config_.room / std::max<std::size_t>(1, sessions_.size());
  return static_cast<std::uint16_t>(std::max<std::size_t>(room_min, share));
}

void udp_port::answer(const udp_address& to, const udp_handshake& x) {
  answered_.push_back({to, encode(x), udp_handshake_size});
  ++counters_.sent;
}

void udp_port::answer_stranger(const udp_address& to, const udp_handshake& x, instant now) {
  if (answers_.free_at() > now) {
    ++counters_.unanswered;
    return;
  }
  answers_.take(1, now);
  answer(to, x);
}

// Time, and what leaves.

void udp_port::on_time(instant now) {
  for (auto x = attempts_.begin(); x != attempts_.end();) {
    auto& [token, attempt] = *x;
    if (attempt.end <= now) {
      events_.push_back(udp_refused{attempt.id, no_answer});
      x = attempts_.erase(x);
      continue;
    }
    if (attempt.next <= now) {
      answer(attempt.to, {attempt.cookie ? step::open : step::hello, room_of_each(), token,
                          attempt.cookie.value_or(0)});
      attempt.next = now + attempt.pause;
      attempt.pause = std::min(2 * attempt.pause, config_.hello_retry_max);
    }
    ++x;
  }
  std::vector<udp_token> over;
  for (auto& [token, x] : sessions_) {
    if (!x.session.on_time(now))
      over.push_back(token);
  }
  for (const auto token : over)
    end_session(token, silent);
}

std::vector<udp_event> udp_port::take_events() {
  for (auto& [token, x] : sessions_) {
    if (x.closes_until)
      continue;
    if (x.wanted && x.session.has_received())
      events_.push_back(udp_received{token, x.session.take_received(std::exchange(spare_, {}))});
    if (const auto octets = x.session.take_acknowledged(); octets > 0)
      events_.push_back(udp_acknowledged{token, octets});
  }
  return std::exchange(events_, {});
}

std::vector<udp_batch> udp_port::flush(instant now) {
  std::vector<udp_token> closed;
  for (const auto& [token, x] : sessions_) {
    if (x.closes_until && (x.session.unacknowledged() == 0 || *x.closes_until <= now))
      closed.push_back(token);
  }
  for (const auto token : closed)
    reset(token);
  auto out = std::exchange(answered_, {});
  const auto room = room_of_each();
  for (auto& [token, x] : sessions_)
    x.session.flush(now, room, out, counters_);
  return out;
}

std::optional<instant> udp_port::deadline() const {
  std::optional<instant> first;
  for (const auto& [token, x] : attempts_)
    first = earliest(first, deadline_of(x));
  for (const auto& [token, x] : sessions_) {
    first = earliest(first, x.session.deadline());
    first = earliest(first, x.closes_until);
  }
  return first;
}

std::size_t udp_port::unacknowledged() const {
  std::size_t sum = 0;
  for (const auto& [token, x] : sessions_)
    sum += x.session.unacknowledged();
  return sum;
}

const udp_session* udp_port::find(udp_token session) const {
  const auto found = sessions_.find(session);
  return found == sessions_.end() ? nullptr : &found->second.session;
}

} // namespace rubicon::peis
