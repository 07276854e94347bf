// How pending feeds are worked off: a slice for each host, in turns.
#include <algorithm>
#include <deque>
#include <utility>

#include "peis/space/subscriber_feed.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

namespace {

// Work in steps of about a quarter of a microsecond: one for a tuple that is looked at.
constexpr std::size_t push_steps = 8;     ///< a message more
constexpr std::size_t visit_steps = 4;    ///< a host that is looked at
constexpr std::size_t slice_steps = 512;  ///< at once for one host
constexpr std::size_t turn_steps = 4096;  ///< at once for all
constexpr std::size_t steps_per_unit = 4; ///< of what a neighbour is charged
constexpr duration turn_gap = 1ms;        ///< then others have their turn
constexpr duration room_check = 100ms;    ///< after there was no room for any host

std::size_t message_size(const tuple& x) {
  return tuple_record_size + x.mimetype.size() + std::max<std::size_t>(1, x.value.size());
}

} // namespace

transmit subscriber_feed::push_message(const tuple& x, peer_id subscriber) {
  return {subscriber,
          port::push,
          {encode_tuple_head(x, tuple_message_kind::push), encode_tuple_value(x)},
          no_request,
          x.from};
}

/// Gives a message a request of ours, by which its outcome is known.
transmit subscriber_feed::in_flight(transmit message, std::optional<std::uint64_t> question,
                                    std::optional<instant> failing_since) {
  message.request =
      window_.leave({message.destination, message.content.size(), question, failing_since});
  return message;
}

bool subscriber_feed::is_blocked(scan& x, std::size_t octets) const {
  if (window_.admits(x.host, octets))
    return false;
  if (window_.idle(x.host)) // no acknowledgement of its own comes when there is room
    x.feed.not_before = x.now + room_check;
  return true;
}

/// @returns whether the host has been asked everything
bool subscriber_feed::send_questions(scan& x) {
  auto& feed = x.feed;
  const auto* known = hosts_.find(x.host);
  if (known == nullptr) {
    feed.questions.reset();
    feed.questions_again.reset();
    feed.undelivered_questions.clear();
    return true;
  }
  const auto ask = [&](const local_subscriptions::question& q, bool refresh) {
    x.take(push_steps);
    auto request = local_.request_to(x.host, known->marked, q.wanted, refresh);
    x.out.push_back(in_flight(std::move(request), q.serial, {}));
  };
  while (feed.questions || !feed.undelivered_questions.empty()) {
    if (x.steps == 0 || is_blocked(x, 2 * tuple_record_size))
      return false;
    x.take(1);
    if (!feed.undelivered_questions.empty()) {
      const auto* q = local_.find_question(*feed.undelivered_questions.begin());
      feed.undelivered_questions.erase(feed.undelivered_questions.begin());
      if (q != nullptr)
        ask(*q, false);
      continue;
    }
    const auto* q = local_.next_question(feed.questions->next);
    if (q == nullptr) {
      feed.questions.reset();
      if (const auto refresh = std::exchange(feed.questions_again, std::nullopt))
        feed.questions = pending_feed::question_scan{0, *refresh};
      continue;
    }
    feed.questions->next = q->serial + 1;
    if (const auto owner = q->wanted.owner; owner == any_peer || owner == x.host)
      ask(*q, feed.questions->refresh);
  }
  return true;
}

/// @returns whether nothing is undelivered any more
bool subscriber_feed::send_undelivered(scan& x) {
  auto& feed = x.feed;
  while (!feed.undelivered.empty()) {
    if (x.steps == 0)
      return false;
    x.take(1);
    auto at = feed.undelivered.upper_bound(feed.undelivered_after);    // in turns: none waits for
    at = at == feed.undelivered.end() ? feed.undelivered.begin() : at; // those before it
    const auto name = key::from_wire(at->first);
    const auto* held = own_.find(*name);
    const auto content = held != nullptr ? *held->content : own_.deletion_of(*name, x.now);
    const auto failing_since = at->second;
    const bool given_up = failing_since && x.now - *failing_since > config_.give_up_push;
    const bool overtaken = channels_.busy(*name, x.host); // by a whole value, with appends
    const bool needed = !given_up && !overtaken && subscribers_.wants(x.host, content);
    if (needed && is_blocked(x, message_size(content)))
      return false;
    feed.undelivered_after = at->first;
    feeds_.remove_undelivered(x.host, feed.undelivered_after);
    counters_.pushes_given_up += given_up ? 1 : 0;
    if (!needed)
      continue;
    x.take(push_steps);
    ++counters_.pushes_retried;
    x.out.push_back(in_flight(push_message(content, x.host), {}, failing_since));
  }
  return true;
}

void subscriber_feed::push_scanned(scan& x, const key& name) {
  if (channels_.busy(name, x.host))
    collapse(name, x.now); // what is in flight would be applied to a value that has it already
  ++counters_.pushes_sent;
  auto message = push_message(*own_.find(name)->content, x.host);
  if (channels_.follows(name))
    transmit_in_order(name, std::move(message), x.out);
  else
    x.out.push_back(in_flight(std::move(message), {}, {}));
}

/// @returns whether all queue scans have come to their end
bool subscriber_feed::scan_queue(scan& x) {
  auto& feed = x.feed;
  while (!feed.queue_scans.empty()) {
    auto& s = *feed.queue_scans.begin()->second;
    auto wanted = s.wanted;
    wanted.owner = self_; // for the search only
    const bool through = own_.walk_on(wanted.name, feed.scanned_after, [&](const auto& entry) {
      if (x.steps == 0)
        return false;
      x.take(1);
      if (!wanted.matches(*entry.content))
        return true;
      if (is_blocked(x, message_size(*entry.content)))
        return false;
      x.take(push_steps);
      push_scanned(x, key(entry.content->name));
      return true;
    });
    if (!through)
      return false;
    feed.scanned_after.clear();
    if (!std::exchange(s.again, false))
      feed.queue_scans.erase(feed.queue_scans.begin());
    else if (x.steps == 0)
      return false;
    x.take(1);
  }
  return true;
}

/// Sends what is due to a host, until there is no room, nothing left or no step.
void subscriber_feed::serve(scan& x) {
  if (x.feed.not_before && *x.feed.not_before > x.now)
    return;
  x.feed.not_before.reset();
  const auto before = x.steps;
  if (send_questions(x) && send_undelivered(x))
    static_cast<void>(scan_queue(x));
  counters_.steps += before - x.steps;
}

/// Forgets a feed with nothing pending, or says when it is looked at again; one whose turn is near
/// keeps it.
void subscriber_feed::plan(peer_id host, instant now) {
  const auto& feed = *feeds_.find(host);
  if (feed.is_empty())
    feeds_.close(host);
  else if (feed.not_before && *feed.not_before > now)
    feeds_.schedule(host, feed.not_before);
  else if (window_.admits(host, tuple_record_size))
    feeds_.schedule(host, earliest(feeds_.due(host), now + turn_gap));
  else if (window_.idle(host))
    feeds_.schedule(host, earliest(feeds_.due(host), now + room_check));
}

/// Does a first piece at once, unless others are being served: then its turn comes.
void subscriber_feed::serve_now(peer_id host, instant now, tuple_events& out) {
  auto* feed = feeds_.find(host);
  if (feed == nullptr)
    return;
  const auto next_turn = feeds_.deadline();
  const bool turn_is_near = next_turn && *next_turn <= now + turn_gap;
  if (!turn_is_near) {
    scan x{host, *feed, slice_steps, now, out};
    serve(x);
    work_.add((slice_steps - x.steps) / steps_per_unit);
  }
  plan(host, now);
}

void subscriber_feed::serve_pending(instant now, tuple_events& out) {
  if (const auto due = feeds_.deadline(); !due || *due > now)
    return;
  auto steps = turn_steps;
  std::deque<peer_id> again; // had a slice and want another
  const auto next = [&] {
    auto host = feeds_.take_due(now);
    if (!host && !again.empty()) {
      host = again.front();
      again.pop_front();
      feeds_.schedule(*host, std::nullopt);
    }
    return host;
  };
  for (auto host = next(); host; host = steps > 0 ? next() : std::nullopt) {
    const auto slice = std::min(steps, slice_steps);
    scan x{*host, *feeds_.find(*host), slice, now, out};
    serve(x);
    steps -= std::min(steps, slice - x.steps + visit_steps);
    if (x.steps == 0)
      again.push_back(*host);
    else
      plan(*host, now);
  }
  for (const auto host : again)
    plan(host, now);
  feeds_.pause(now + turn_gap);
}

} // namespace rubicon::peis
