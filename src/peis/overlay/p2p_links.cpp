// Links: request, greeting, writing, closing (peis-wire.md 3).
#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

namespace {

std::uint64_t tables_per_second(const table_limits& x) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(1, 1s / x.table_gap));
}

constexpr duration judging_gap = 1s;
constexpr duration naming_time = 5s;      ///< to say who one is, on a link that one has asked for
constexpr duration lasting = 30s;         // a link that has been of use
constexpr duration at_once = 1s;          ///< a link that is closed so soon was refused
constexpr duration retry_after_loss = 1s; // a real kernel cuts a reborn peer off once (25.8)

} // namespace

void p2p::on_link_open(link_id link, link_role role, instant now,
                       std::optional<attempt_id> attempt_made) {
  if (connections_.contains(link))
    return;
  const auto asked = attempt_made ? attempts_.extract(*attempt_made) : attempts_node();
  const bool too_late = attempt_made && asked.empty();
  const bool too_many = role == link_role::initiator && open_links() >= config_.links_max;
  if (too_many || left_ || too_late || rivalry_.is_away()) {
    ++counters_.links_refused;
    events_.push_back(close_link{link, left_                ? close_cause::host_left
                                       : rivalry_.is_away() ? close_cause::own_id
                                       : too_late           ? close_cause::unneeded
                                                            : close_cause::too_many_links});
    return;
  }
  latest_ = now;
  if (connections_.size() - open_links() >= config_.greetings_max)
    evict_greeting();
  ++counters_.links_opened;
  auto& x = connections_[link];
  x.id = link;
  x.cost = config_.cost_other_host;
  x.queue = outgoing_queue(config_.queue, queues_);
  x.table_rate = rate_limit(tables_per_second(config_.tables), 2s, 1s);
  x.budget = neighbour_budget(config_.budget);
  x.opened = x.last_heard = x.last_octets = now;
  x.beat_sent = now - 1h; // never yet
  if (!asked.empty()) {
    x.tried_for = asked.mapped().host;
    x.tried_here = asked.mapped().loopback;
    on_attempt_ended(asked.mapped(), true, now);
    if (asked.mapped().standing)
      standing_[*asked.mapped().standing].link = link;
  }
  if (role == link_role::initiator) {
    x.open = true;
    x.request_flags = asked.empty() ? connect_request::all_broadcasts | connect_request::for_merge
                                    : asked.mapped().flags;
    x.preamble =
        encode(connect_request{protocol_version, self_.id, x.request_flags, config_.network});
    greet(x);
  }
  watch_silence(x);
}

std::vector<link_view> p2p::links() const {
  std::vector<link_view> all;
  for (const auto& [link, x] : connections_)
    all.push_back({link, x.neighbour, x.octets_in, x.octets_out, x.loss, x.queue.size()});
  return all;
}

/// Decides on a connect request (peis-wire.md 3.2).
void p2p::accept(connection& from, byte_view request, instant now) {
  const auto decoded = decode_connect_request(request);
  std::optional<close_cause> why;
  if (!decoded)
    why = close_cause::bad_stream;
  else if (decoded->version != protocol_version)
    why = close_cause::wrong_version;
  else if (decoded->network != config_.network)
    why = close_cause::wrong_network;
  else if (decoded->id == self_.id)
    why = close_cause::own_id;
  else if (decoded->id.value <= 0)
    why = close_cause::bad_id;
  else if (const auto known = hosts_.find(decoded->id);
           config_.connections.leaf && known != hosts_.end() && !is_here(known->second.record))
    why = close_cause::leaf;
  if (!why && !has_room_for(*decoded, now)) {
    why = close_cause::too_many_links;
    ++counters_.newcomers_referred;
    refer_elsewhere(from, now);
  }
  if (why) {
    ++counters_.links_refused;
    if (*why == close_cause::own_id)
      refuse_own_id(from);
    close(from.id, *why, now);
    return;
  }
  from.request_flags = decoded->flags;
  from.open = true;
  from.asked_at = now;
  from.last_heard = now;
  bind_neighbour(from, decoded->id, now);
  greet(from);
}

/// May the peer that asks have a link? Closes another for it if that is worth less (CM-09).
bool p2p::has_room_for(const connect_request& request, instant now) {
  if (open_links() >= config_.links_max)
    return replace_least(now);
  // What a link is worth takes a walk over all ways: only if it decides, and not for each who asks.
  const bool judged =
      (request.flags & connect_request::for_bandwidth) != 0 && now >= next_judgement_;
  std::vector<link_option> options;
  if (judged) {
    options = link_options(now);
  } else {
    for (const auto& [link, x] : connections_) {
      if (x.open && !x.always())
        options.push_back({link, std::nullopt});
    }
  }
  switch (admit(request.flags, options, config_.connections)) {
  case admission::accept:
    return true;
  case admission::refuse:
    next_judgement_ = judged ? now + judging_gap : next_judgement_;
    return false;
  case admission::replace_worst:
    close(worst_of(options)->link, close_cause::unneeded, now);
    return true;
  }
  return false;
}

/// All links are in use. One whose neighbour has asked for it and never said who it is goes, or one
/// that leads nowhere that others do not lead; these are not judged anew for each who asks.
bool p2p::replace_least(instant now) {
  for (const auto& [link, x] : connections_) {
    if (x.asked_at && *x.asked_at + naming_time <= now && !x.named) {
      close(link, close_cause::nameless, now);
      return true;
    }
  }
  if (now < next_judgement_)
    return false;
  const auto worst = worst_of(link_options(now));
  if (!worst) {
    next_judgement_ = now + judging_gap;
    return false;
  }
  close(worst->link, close_cause::unneeded, now);
  return true;
}

/// Share of packages missed, as real kernels average it, here over packages instead of time.
void p2p::note_counter(connection& x, std::uint32_t counter) {
  constexpr double smoothing = 0.01;
  const auto expected = x.counter_heard ? *x.counter_heard + 1 : counter;
  const auto missed = std::min<std::uint32_t>(counter - expected, 100);
  if (counter - expected < 0x80000000U) {
    for (std::uint32_t i = 0; i < missed; ++i)
      x.loss += smoothing * (1 - x.loss);
    x.loss -= smoothing * x.loss;
    x.counter_heard = counter;
  }
}

/// Our record, our record again for all if this is our first contact, our routes
/// (peis-wire.md 3.3).
void p2p::greet(connection& to) {
  const auto content = std::make_shared<const message_octets>(
      message_octets{encode(host_record_message{self_, false}), {}});
  enqueue(to, lane::control, {fresh_header(package_type::link, port::host_record), content, 0});
  if (routing_.routes().empty())
    flood(fresh_header(package_type::broadcast, port::host_record), content, {});
  routing_.next_seqno();
  send_routing_to(to);
}

void p2p::bind_neighbour(connection& x, peer_id neighbour, instant now) {
  x.neighbour = neighbour;
  const auto [at, is_first] = neighbours_.try_emplace(neighbour, x.id);
  if (!is_first && !connections_.contains(at->second))
    at->second = x.id;
  expect_beat(x);
  watch_doubt(x);
  welcome(neighbour, now);
}

void p2p::on_link_sent(link_id link, std::size_t octets, instant now) {
  const auto at = connections_.find(link);
  if (at == connections_.end())
    return;
  auto& x = at->second;
  x.unreported -= std::min(octets, x.unreported);
  x.drained = now;
  while (!x.leaving.empty() && x.leaving.front().first + x.unreported <= x.octets_out) {
    delivery_.on_transmitted(x.leaving.front().second, now);
    x.leaving.pop_front();
  }
}

/// What has not left over a link that is gone. Real kernels may have taken parts of messages, which
/// they drop before the rest comes over another link.
void p2p::drop_output(connection& gone, instant now) {
  std::set<peer_id> broken_off;
  const auto drop = [&](std::int32_t ack_id) {
    if (const auto to = delivery_.destination_of(ack_id); to && gone.paced)
      broken_off.insert(*to);
    delivery_.on_dropped(ack_id, now);
  };
  for (const auto& [end, ack_id] : gone.leaving)
    drop(ack_id);
  while (const auto x = gone.queue.pop()) {
    if (x->header.reliable() && x->header.source == self_.id) {
      drop(x->header.ack_id);
    } else {
      ++counters_.queued_lost;
      rubicon::note_loss(x->from, loss::package_lost);
    }
  }
  if (gone.paced && gone.neighbour)
    broken_off.insert(*gone.neighbour);
  begin_anew(broken_off);
}

/// A link that its other end closes at once, without having said who it is, is a refusal; the first
/// may be a mistake, after a restart (25.8). Whoever uses our id, or knows who does, asks again.
void p2p::on_link_closed(link_id link, instant now) {
  const auto at = connections_.find(link);
  if (at == connections_.end())
    return;
  const auto& x = at->second;
  const bool is_refusal = now < x.opened + at_once && !x.named && !x.rivals;
  const bool has_lasted = x.opened + lasting <= now;
  const auto sought = x.tried_for;
  const auto standing = std::ranges::find(standing_, std::optional(link), &standing_address::link);
  forget_link(link, now);
  if (is_refusal && sought && !neighbours_.contains(*sought)) // else one of two went
    note_refusal(*sought, now);
  if (standing == standing_.end())
    return;
  standing->refusals = is_refusal ? standing->refusals + 1 : has_lasted ? 0 : standing->refusals;
  if (is_refusal && standing->refusals > 1)
    standing->next = now + refused_wait(standing->refusals - 2);
}

void p2p::close(link_id link, close_cause why, instant now) {
  events_.push_back(close_link{link, why});
  forget_link(link, now);
}

void p2p::forget_link(link_id link, instant now) {
  const auto at = connections_.find(link);
  if (at == connections_.end())
    return;
  auto gone = std::move(at->second);
  connections_.erase(at);
  seen_.on_link_closed(link);
  if (gone.neighbour) {
    if (gone.opened + lasting <= now)
      contacts_.erase(*gone.neighbour); // the tries that led to it are forgotten
    if (!is_doubtful(gone, now))        // long looked for beside
      note_contact(*gone.neighbour, now);
  }
  for (auto& x : standing_) {
    if (x.link == link) {
      x.link.reset();
      x.next = now + retry_after_loss;
    }
  }
  drop_output(gone, now);
  if (gone.neighbour && neighbours_.at(*gone.neighbour) == link) {
    neighbours_.erase(*gone.neighbour);
    for (const auto& [other, x] : connections_) {
      if (x.neighbour == gone.neighbour)
        neighbours_.try_emplace(*gone.neighbour, other);
    }
  }
  std::erase_if(heard_over_, [link](const auto& x) { return x.second == link; });
  if (gone.waits)
    std::erase_if(resting_, [link](const auto& x) { return x.second == link; });
  apply(routing_.on_link_closed(link, now), now);
}

duration p2p::patience(const connection& x) const {
  if (!x.open)
    return config_.handshake_timeout;
  if (x.octets_in == 0)
    return config_.greeting_timeout;
  return x.beat && is_marked(x) ? config_.heartbeat_timeout : config_.link_timeout;
}

/// A link also falls silent when what it was given does not leave.
instant p2p::silence_deadline(const connection& x) const {
  return std::min(x.last_heard + patience(x), drain_deadline(x));
}

instant p2p::drain_deadline(const connection& x) const {
  return x.unreported > 0 ? x.drained + config_.link_timeout : instant::max();
}

void p2p::watch_silence(const connection& x) {
  next_silence_check_ = earliest(next_silence_check_, silence_deadline(x));
}

void p2p::check_silence(instant now) {
  if (!next_silence_check_ || now < *next_silence_check_)
    return;
  std::vector<std::pair<link_id, close_cause>> silent;
  next_silence_check_.reset();
  for (const auto& [link, x] : connections_) {
    const bool waits = x.open && x.waits; // what it has said is still to be heard
    if (waits && drain_deadline(x) > now)
      next_silence_check_ = earliest(next_silence_check_, now + config_.heartbeat_timeout);
    else if (waits || silence_deadline(x) <= now)
      silent.emplace_back(link, x.open ? close_cause::silent : close_cause::handshake_silent);
    else
      watch_silence(x);
  }
  for (const auto& [link, why] : silent) {
    ++(why == close_cause::silent ? counters_.links_broken : counters_.links_refused);
    close(link, why, now);
  }
}

void p2p::flush(instant now) {
  repeat_due(now);
  for (const auto& [to, ids] : acknowledger_.take(now))
    send_acknowledgements(to, ids);
  ask_strangers(now);
  if (next_trigger_ && *next_trigger_ <= now)
    send_routing(now);
  for (bool progress = true; progress;) {
    progress = false;
    for (auto& [link, x] : connections_)
      progress = write(x, now) || progress;
    begin_anew(delivery_.take_stale());
    for (const auto destination : std::exchange(stalled_, {}))
      pump(destination);
  }
}

/// A neighbour of another kind, which may take the first part of a package and wait for the rest.
void p2p::pace(connection& x) {
  if (x.paced || config_.link_window == 0)
    return;
  x.paced = true;
  events_.push_back(pace_link{x.id});
}

/// May so many octets more be handed out, and a package?
bool p2p::has_window(const connection& to, std::size_t more) const {
  const auto out = to.unreported + more;
  if (to.paced)
    return out == 0 || out + header_size + data_max <= config_.paced_window;
  return config_.link_window == 0 || out < config_.link_window;
}

/// Hands out what is queued, as far as the link's window allows: over a paced link package by
/// package.
bool p2p::write(connection& to, instant now) {
  if (to.queue.empty() || !to.open)
    return false;
  bytes out = std::exchange(to.preamble, {});
  bool any = false;
  while (has_window(to, out.size()) && encode_next(to, out, now)) {
    any = true;
    if (to.paced)
      hand_out(to, std::exchange(out, {}), now);
  }
  if (out.empty())
    return any;
  hand_out(to, std::move(out), now);
  return true;
}

/// The next package that is still wanted. @returns false if there is none
bool p2p::encode_next(connection& to, bytes& out, instant now) {
  for (auto x = to.queue.pop(); x; x = to.queue.pop()) {
    const bool awaited = x->header.reliable() && x->header.source == self_.id;
    if (awaited && !delivery_.wanted(x->header.ack_id))
      continue;
    if (carries_content(x->header.port)) {
      const acting_on its(x->from);
      static_cast<void>(provenance::begin("package_sent", name_of(x->header)));
      package_departs(name_of(x->header), to.id >= config_.outside_from);
    }
    encode(*x, to.counter++, out);
    if (to.id >= config_.outside_from && x->header.port == port::host_record && x->offset == 0)
      hide_inproc(std::span(out).last(x->length()));
    ++counters_.packages_sent;
    if (awaited && config_.link_window == 0)
      delivery_.on_transmitted(x->header.ack_id, now);
    else if (awaited) // the wait for an acknowledgement begins when it has left
      to.leaving.emplace_back(to.octets_out + out.size(), x->header.ack_id);
    return true;
  }
  return false;
}

void p2p::hand_out(connection& to, bytes octets, instant now) {
  counters_.octets_sent += octets.size();
  to.octets_out += octets.size();
  to.last_written = now;
  const bool waited = to.unreported > 0;
  to.drained = waited ? to.drained : now;
  to.unreported += config_.link_window == 0 ? 0 : octets.size();
  if (!waited)
    watch_doubt(to);
  events_.push_back(to_link{to.id, std::move(octets)});
}

} // namespace rubicon::peis
