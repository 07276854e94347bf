#include "transport/messenger.hpp"

#include <algorithm>

#include "core/account/message_ledger.hpp"

namespace rubicon::transport {

namespace {

/// Is `a` ahead of `b`, of numbers that wrap at `modulus`?
bool is_ahead(unsigned a, unsigned b, unsigned modulus) {
  const auto distance = (a + modulus - b) % modulus;
  return distance != 0 && distance < modulus / 2;
}

bool is_later(std::uint16_t a, std::uint16_t b) {
  return is_ahead(a, b, counter_max + 1U);
}

std::uint16_t after(std::uint16_t counter) {
  return static_cast<std::uint16_t>((counter + 1) & counter_max);
}

/// Removes the entry of a map that was used longest ago, of those that may go.
template <class Map, class MayGo>
void forget_oldest(Map& entries, MayGo may_go) {
  auto oldest = entries.end();
  for (auto x = entries.begin(); x != entries.end(); ++x) {
    if (may_go(x->second) && (oldest == entries.end() || x->second.used < oldest->second.used))
      oldest = x;
  }
  if (oldest != entries.end())
    entries.erase(oldest);
}

} // namespace

messenger::messenger(messenger_config config, random_stream rng)
    : config_(config), next_counter_(static_cast<std::uint16_t>(rng.next() & counter_max)) {}

mote_address messenger::resolved(mote_address x) const {
  if (x.island == own_island)
    x.island = island_;
  if (x.mote == own_mote)
    x.mote = config_.self;
  return x;
}

std::optional<outputs> messenger::send(ticket id, mote_address destination, std::uint8_t am_type,
                                       bytes payload, bool reliable, instant now) {
  destination = resolved(destination);
  const bool is_bad =
      payload.size() > config_.payload_max || (reliable && destination.mote == broadcast_mote);
  const bool is_crowded = reliable && outstanding_ >= config_.outstanding_max;
  if (is_bad || is_crowded) {
    ++counters_.refused;
    counters_.refused_crowded += is_bad ? 0 : 1;
    return std::nullopt;
  }
  outputs out;
  if (!reliable) {
    ++counters_.unreliable_sent;
    segment x;
    x.source = config_.self;
    x.am_type = am_type;
    x.payload = std::move(payload);
    out.emplace_back(to_network{destination, am_type, encode(x)});
    return out;
  }
  ++counters_.reliable_sent;
  ++outstanding_;
  auto& to = session_with(destination);
  to.messages.push_back({id, am_type, std::move(payload)});
  if (!to.due)
    begin(destination, to, out, now);
  return out;
}

messenger::session& messenger::session_with(mote_address destination) {
  auto found = sessions_.find(destination);
  if (found == sessions_.end()) {
    if (sessions_.size() >= config_.sessions_max)
      forget_oldest(sessions_, [](const session& x) { return x.messages.empty(); });
    found = sessions_.emplace(destination, session{}).first;
    found->second.counter = next_counter_;
  }
  found->second.used = ++uses_;
  return found->second;
}

void messenger::forget_incarnation(mote_address destination) {
  const auto found = sessions_.find(resolved(destination));
  if (found != sessions_.end() && !found->second.due)
    found->second.receiver.reset();
}

/// The first message of a session, or the greeting before it, begins its attempts.
void messenger::begin(mote_address destination, session& x, outputs& out, instant now) {
  x.counter = after(x.counter);
  if (is_later(x.counter, next_counter_))
    next_counter_ = x.counter;
  x.attempts = 0;
  attempt(destination, x, out, now);
}

void messenger::attempt(mote_address destination, session& x, outputs& out, instant now) {
  const auto& first = x.messages.front();
  const acting_on its(first.from);
  const acting_on this_one(provenance::begin("attempt"));
  segment content;
  content.source = config_.self;
  content.counter = x.counter;
  content.sender = static_cast<incarnation>(config_.incarnation % sender_incarnations);
  content.am_type = first.am_type;
  if (x.receiver) {
    content.what = segment::kind::reliable;
    content.receiver = *x.receiver;
    content.payload = first.payload;
  } else {
    content.what = segment::kind::hello;
    ++counters_.hellos;
  }
  out.emplace_back(to_network{destination, first.am_type, encode(content)});
  if (x.attempts == 0)
    x.asked = now;
  const auto wait = std::max(config_.ack_wait * (1U << x.attempts), x.answer_wait);
  x.due = std::min(now + wait + slack_to(destination), gives_up(destination, x));
  ++x.attempts;
}

duration messenger::far_slack(mote_address destination) const {
  const bool is_near = destination.island == island_ || destination.island == own_island;
  return config_.self != no_mote && is_near ? 0s
                                            : slack_of(config_.slacks, destination).there_and_back;
}

duration messenger::slack_to(mote_address destination) const {
  return own_slack_ + far_slack(destination);
}

outputs messenger::on_segment(island_id source_island, byte_view octets, instant now,
                              const std::function<bool(std::uint8_t)>& has_program) {
  outputs out;
  auto decoded = decode_segment(octets);
  if (!decoded) {
    ++counters_.malformed;
    note_loss(loss::malformed);
    return out;
  }
  segment& x = *decoded;
  const mote_address from{source_island, x.source};
  switch (x.what) {
  case segment::kind::plain:
    ++counters_.received;
    out.emplace_back(received{from, x.am_type, std::move(x.payload)});
    break;
  case segment::kind::reliable:
    on_reliable(from, std::move(x), !has_program || has_program(x.am_type), out, now);
    break;
  case segment::kind::hello:
    on_hello(from, x, out, now);
    break;
  case segment::kind::acknowledgement:
  case segment::kind::busy:
  case segment::kind::refused:
  case segment::kind::no_program:
    on_answer(from, x, out, now);
    break;
  }
  return out;
}

void messenger::answer(mote_address to, const segment& x, segment::kind what, outputs& out) const {
  segment content;
  content.source = config_.self;
  content.counter = x.counter;
  content.sender = x.sender;
  content.am_type = x.am_type;
  content.what = what;
  content.receiver = static_cast<incarnation>(config_.incarnation % receiver_incarnations);
  out.emplace_back(to_network{to, x.am_type, encode(content)});
}

/// One of an earlier incarnation, or of before other messages, may have been in flight for long.
void messenger::on_hello(mote_address from, const segment& x, outputs& out, instant now) {
  const auto known = sources_.find(from);
  const bool is_again = known != sources_.end() && x.sender == known->second.sender &&
                        x.counter == known->second.counter;
  const bool is_old = known != sources_.end() && !is_again &&
                      now - known->second.last_received < config_.lifetime + slack_to(from) &&
                      (x.sender == known->second.sender
                           ? !is_later(x.counter, known->second.counter)
                           : !is_ahead(x.sender, known->second.sender, sender_incarnations));
  if (is_old) {
    ++counters_.duplicates;
    note_loss(loss::unanswered);
    return;
  }
  if (known == sources_.end() && sources_.size() >= config_.sources_max)
    forget_oldest(sources_, [](const source&) { return true; });
  sources_[from] = {x.sender, x.counter, now, ++uses_};
  note_loss(loss::unanswered); // unless more comes of it
  answer(from, x, segment::kind::acknowledgement, out);
}

void messenger::on_reliable(mote_address from, segment x, bool has_program, outputs& out,
                            instant now) {
  const auto known = sources_.find(from);
  const auto self = static_cast<incarnation>(config_.incarnation % receiver_incarnations);
  if (x.receiver != self || known == sources_.end() || x.sender != known->second.sender) {
    ++counters_.strangers;
    note_loss(loss::not_taken);
    answer(from, x, segment::kind::refused, out);
    return;
  }
  auto& history = known->second;
  history.used = ++uses_;
  history.last_received = now;
  if (!is_later(x.counter, history.counter)) {
    ++counters_.duplicates;
    if (x.counter == history.counter) // its acknowledgement may have been lost
      answer(from, x, segment::kind::acknowledgement, out);
    return;
  }
  if (!has_program) {
    ++counters_.no_program;
    note_loss(loss::no_program);
    answer(from, x, segment::kind::no_program, out);
    return;
  }
  if (held_.contains(x.am_type)) {
    ++counters_.throttled;
    note_loss(loss::not_taken);
    answer(from, x, segment::kind::busy, out);
    return;
  }
  history.counter = x.counter;
  ++counters_.received;
  answer(from, x, segment::kind::acknowledgement, out);
  out.emplace_back(received{from, x.am_type, std::move(x.payload)});
}

void messenger::on_answer(mote_address from, const segment& x, outputs& out, instant now) {
  const auto found = sessions_.find(from);
  const bool is_ours = found != sessions_.end() && found->second.due &&
                       x.counter == found->second.counter &&
                       x.sender == config_.incarnation % sender_incarnations;
  if (!is_ours) {
    ++counters_.stray_answers;
    return;
  }
  auto& to = found->second;
  learn(from, to, now);
  if (!to.receiver) {
    if (x.what == segment::kind::acknowledgement) {
      to.receiver = x.receiver;
      begin(from, to, out, now);
    }
  } else if (x.what == segment::kind::acknowledgement) {
    end_first(from, to, true, out, now);
  } else if (x.what == segment::kind::busy) { // so no copy has been passed up
    to.attempts = 0;
    to.due = now + config_.busy_wait;
  } else if (x.what == segment::kind::no_program) {
    ++counters_.failed_no_program;
    end_first(from, to, false, out, now);
  } else {
    const bool is_same = x.receiver == to.receiver; // it has only forgotten us
    to.receiver.reset();
    if (is_same && to.attempts == 1) {
      begin(from, to, out, now);
    } else {
      ++counters_.failed_refused;
      end_first(from, to, false, out, now);
    }
  }
}

/// Only answers to first attempts measure the time that answers take; of others we do not know
/// which attempt they answer, and wait longer until one measures it (Karn and Partridge; RFC 6298
/// 5). The time that radios sleep is known, and added to each wait.
void messenger::learn(mote_address from, session& x, instant now) const {
  const auto taken = now - x.asked - slack_to(from);
  const auto wanted =
      x.attempts > 1 ? 2 * std::max(x.answer_wait, config_.ack_wait) : 2 * std::max(taken, 0ns);
  x.answer_wait = std::clamp(wanted, x.answer_wait / 2, config_.answer_wait_max);
}

instant messenger::gives_up(mote_address destination, const session& x) const {
  const auto waits = config_.ack_wait * ((1U << config_.attempts_max) - 1);
  return x.asked + waits + config_.attempts_max * slack_to(destination);
}

/// The first message of a session has ended; the next one begins.
void messenger::end_first(mote_address destination, session& x, bool acked, outputs& out,
                          instant now) {
  ++(acked ? counters_.reliable_acked : counters_.reliable_failed);
  --outstanding_;
  out.emplace_back(outcome{x.messages.front().id, acked});
  x.messages.erase(x.messages.begin());
  x.due.reset();
  if (!x.messages.empty())
    begin(destination, x, out, now);
  else if (sessions_.size() > config_.sessions_max)
    sessions_.erase(destination);
}

outputs messenger::on_time(instant now) {
  outputs out;
  std::vector<mote_address> due;
  for (const auto& [destination, x] : sessions_) {
    if (x.due && *x.due <= now)
      due.push_back(destination);
  }
  for (const auto destination : due) {
    auto& x = sessions_.at(destination);
    if (x.attempts >= config_.attempts_max || (x.attempts > 0 && gives_up(destination, x) <= now)) {
      x.receiver.reset(); // perhaps it has been replaced by another incarnation
      ++counters_.failed_unanswered;
      end_first(destination, x, false, out, now);
    } else {
      counters_.retries += x.attempts > 0 ? 1 : 0;
      attempt(destination, x, out, now);
    }
  }
  return out;
}

std::optional<instant> messenger::deadline() const {
  std::optional<instant> next;
  for (const auto& [destination, x] : sessions_)
    next = earliest(next, x.due);
  return next;
}

outputs messenger::fail_all() {
  outputs out;
  for (const auto& [destination, to] : sessions_) {
    for (const auto& x : to.messages) {
      note_loss(x.from, loss::sender_left);
      out.emplace_back(outcome{x.id, false});
    }
  }
  counters_.reliable_failed += outstanding_;
  counters_.failed_left += outstanding_;
  outstanding_ = 0;
  sessions_.clear();
  return out;
}

} // namespace rubicon::transport
