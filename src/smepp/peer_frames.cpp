// What comes to a peer from its radio, what goes there, and when the radio is on.
#include <algorithm>
#include <cassert>

#include "core/overloads.hpp"
#include "smepp/smepp.hpp"

namespace rubicon::smepp {

namespace {

using std::chrono::microseconds;

constexpr duration reply_wait = 100ms; ///< the radio stays on for an answer to a challenge

/// How far `x` is into the present turn of something that comes back each `period`.
duration phase(microseconds x, duration period) {
  const auto rest = duration(x) % period;
  return rest < duration{} ? rest + period : rest;
}

/// Until a frame may be begun in windows of this length; 0: now.
duration until_window(microseconds since_first, duration period, duration length,
                      duration frame_time) {
  if (length >= period)
    return {};
  const auto at = phase(since_first, period);
  return at < std::max(length - frame_time, duration{1}) ? duration{} : period - at;
}

} // namespace

// ---- what comes

void peer::on_frame(mote_id from, mote_id to, byte_view octets, instant at, instant now,
                    outputs& out) {
  const auto content = security_.open(from, to, octets, now);
  if (const auto* const refused = std::get_if<refused_frame>(&content)) {
    if (refused->is_ahead)
      groups_.on_foreign_keys(from, refused->group, with(now));
    return go_on(now, out);
  }
  const auto& frame = std::get<opened_frame>(content);
  const auto x = decode(frame.content);
  if (!x)
    drop("malformed");
  else if (from == config_.self || from.value == 0 || from.value > mote_id_max)
    drop("bad_sender");
  else if (is_network_level(*x) != (frame.group == network_level))
    drop("wrong_level");
  else if (frame.group == network_level)
    on_network_frame(from, *x, frame, now);
  else if (!frame.is_proven)
    on_unproven(from, *x, frame, now);
  else
    on_group_frame(from, *x, frame, at, now);
  go_on(now, out);
}

/// What a handshake ends with is followed by more, which a member need not be awake for.
void peer::on_network_frame(mote_id from, const message& x, const opened_frame& frame,
                            instant now) {
  const bool is_question = std::holds_alternative<discover>(x) || std::holds_alternative<join>(x) ||
                           std::holds_alternative<join_proof>(x);
  if (is_question && !security_.is_new_request(from, frame, now))
    return;
  groups_.on_message(from, x, frame, with(now));
  if (std::holds_alternative<join_accept>(x))
    awake_until_ = std::max(awake_until_, now + 3 * reply_wait);
}

/// Authentic, but its sender may have said it long ago: only questions and answers about that.
void peer::on_unproven(mote_id from, const message& x, const opened_frame& frame, instant now) {
  if (const auto* const asked = std::get_if<challenge>(&x))
    return answer_challenge(from, *asked, frame, now);
  if (const auto* const answer = std::get_if<proof>(&x)) {
    if (!security_.on_proof(from, frame, answer->nonce))
      drop("old_proof");
    return;
  }
  security_.count(refusal::unproven);
  groups_.on_member_frame(from, frame.group, false, with(now));
  if (const auto nonce = security_.challenge(from, frame.group, now)) {
    to_send question{from, frame.group, challenge{*nonce}, slot::at_once};
    question.under = frame.session;
    awake_until_ = std::max(awake_until_, now + reply_wait);
    static_cast<void>(outbox_.push(question, now));
  }
}

void peer::answer_challenge(mote_id from, const challenge& x, const opened_frame& frame,
                            instant now) {
  if (!security_.may_prove(from, now))
    return drop("too_many_challenges");
  to_send answer{from, frame.group, proof{x.nonce}, slot::at_once};
  answer.under = frame.session;
  static_cast<void>(outbox_.push(answer, now));
}

void peer::on_group_frame(mote_id from, const message& x, const opened_frame& frame, instant at,
                          instant now) {
  auto* const g = groups_.find(frame.group);
  if (g == nullptr || g->leaving_at)
    return drop("no_member");
  groups_.on_member_frame(from, frame.group, true, with(now));
  check_step(x, frame.group, now);
  const bool knows_time = g->sync.is_known();
  std::visit(
      overloads{[&](const sync_stamp& body) { on_stamp(from, body, frame.group, at, now); },
                [&](const subscribe& body) {
                  if (knows_time)
                    events_.on_message(from, body, *g, with(now));
                },
                [&](const unsubscribe& body) { events_.on_message(from, body, *g, with(now)); },
                [&](const event& body) { events_.on_message(from, body, *g, with(now)); },
                [&](const challenge& body) { answer_challenge(from, body, frame, now); },
                [&](const proof&) {}, // it has been believed meanwhile
                [&](const auto&) { groups_.on_message(from, x, frame, with(now)); }},
      x);
}

/// What is only sent in windows was sent outside of ours: a part of the group goes by another time.
/// Its windows are now, so ours is sent to it; whichever is better holds.
void peer::check_step(const message& x, group_id group, instant now) {
  constexpr duration pause = 10s;
  auto& g = *groups_.find(group);
  const auto& cycle = g.description.management;
  if (!(std::holds_alternative<sync_stamp>(x) || std::holds_alternative<subscribe>(x)) ||
      cycle.period == duration{} || !g.sync.is_fine() || now < g.out_of_step_from)
    return;
  const auto at = phase(g.sync.at(now).time_since_epoch(), cycle.period);
  const auto slack = 2 * config_.energy.radio_delay;
  if (at < cycle.length + slack || at > cycle.period - slack)
    return;
  g.out_of_step_from = now + pause;
  g.sync.chase(now);
  to_send stamps{broadcast_mote, group, sync_stamp{}, slot::at_once};
  stamps.copies = 3;
  static_cast<void>(outbox_.push(stamps, now));
}

/// If the group's time turns out to be another one, our neighbours that go by the old one are sent
/// it in a window that they are still awake in.
void peer::on_stamp(mote_id from, const sync_stamp& x, group_id group, instant at, instant now) {
  auto& g = *groups_.find(group);
  const auto cycle = g.description.management;
  const bool was_fine = g.sync.is_fine();
  std::optional<instant> old_window;
  if (was_fine && cycle.period > 0s) {
    const auto since = g.sync.at(now).time_since_epoch();
    old_window = now + cycle.period - phase(since, cycle.period);
  }
  const auto before = old_window ? g.sync.at(*old_window) : group_time{};
  groups_.on_stamp(from, x, group, at, with(now));
  const bool jumped =
      old_window && std::chrono::abs(g.sync.at(*old_window) - before) > config_.groups.sync.jump;
  if (jumped) {
    to_send farewell{broadcast_mote, group, sync_stamp{}, slot::at_once};
    farewell.delay = *old_window - now + rng_.between(duration{}, cycle.length / 4);
    farewell.copies = 3;
    static_cast<void>(outbox_.push(farewell, now));
    awake_until_ = std::max(awake_until_, *old_window + cycle.period);
  }
  set_cycles(now);
}

void peer::on_sent(std::uint64_t id, bool acked, instant at, instant now, outputs& out) {
  if (!flight_ || flight_->id != id)
    return;
  const auto ended = *flight_;
  flight_.reset();
  if (auto* const g = groups_.find(ended.stamp); g != nullptr && acked)
    g->sync.on_stamp_sent(at);
  end_hop(ended.token, acked, now);
  go_on(now, out);
}

// ---- what goes

/// How long until those are awake that a message is for.
outbox::pause peer::wait(const to_send& x, instant now) const {
  const auto schedule = groups_.schedule_of(x.group, now);
  if (x.when == slot::at_once || !schedule || schedule->cycle.period == duration{})
    return {};
  const auto& cycle = schedule->cycle;
  const auto management = until_window(schedule->now.time_since_epoch(), cycle.period, cycle.length,
                                       config_.frame_time);
  // What others did not receive is not repeated: such frames keep clear of each other, and of the
  // begin of windows, which events have as well.
  if (x.to == broadcast_mote)
    return {management, (cycle.length - config_.frame_time) * 2 / 3};
  outbox::pause until{management, config_.send_spread};
  const auto* const tree =
      x.when == slot::subscription ? events_.find(x.group, x.subscription) : nullptr;
  if (tree != nullptr && tree->interval > duration{})
    until.left = std::min(until.left, until_window(schedule->now - tree->made_at, tree->interval,
                                                   config_.event_window, config_.frame_time));
  return until;
}

void peer::pump(instant now, outputs& out) {
  const auto wait_for = [this](const to_send& x, instant at) { return wait(x, at); };
  while (!flight_) {
    const auto x = outbox_.take(now, wait_for);
    if (!x)
      return;
    if (hand_out(*x, now, out))
      continue;
    drop("not_sealed");
    end_hop(x->token, false, now);
  }
}

/// What is only known when a message leaves.
void peer::complete(message& content, const to_send& x, instant now) {
  auto* const g = groups_.find(x.group);
  if (g == nullptr)
    return;
  std::visit(overloads{[&](answer& body) {
                         body.time = g->sync.at(now);
                         if (body.proof)
                           body.proof =
                               answer_tag(*g->description.master, x.to, config_.self, body);
                       },
                       [&](join_accept& body) {
                         body.time = g->sync.at(now);
                         body.subscriptions = static_cast<std::uint8_t>(events_.count(x.group));
                         bind_carrier(*x.bound_under, body.keys, carrier_of(body));
                       },
                       [&](sync_stamp& body) {
                         g->sync.stamp(body, now);
                         body.digest = g->members.digest();
                         body.best = g->ring.best().id;
                       },
                       [](const auto&) {}},
             content);
}

bool peer::hand_out(const to_send& x, instant now, outputs& out) {
  auto content = x.content;
  const auto* const g = groups_.find(x.group);
  const bool is_network = is_network_level(content);
  if (!is_network && g == nullptr)
    return false;
  complete(content, x, now);
  const auto session = is_network ? session_id{} : x.under.value_or(g->ring.sending(now));
  auto frame = security_.seal(x.to, is_network ? network_level : x.group, session, encode(content));
  if (!frame)
    return false;
  if (const auto reserved = security_.take_store()) {
    persistent_.counter_reserved = *reserved;
    out.emplace_back(store_state{persistent_});
  }
  ++counters_.frames_sent;
  counters_.octets_sent += frame->size();
  ++counters_.sent[std::string(name_of(content))];
  const bool is_stamp = std::holds_alternative<sync_stamp>(content);
  flight_ = {++frame_, x.token, is_stamp ? x.group : network_level, now + config_.sent_timeout};
  set_radio_state(now, out);
  const bool is_event = std::holds_alternative<event>(content); // others are the group's own affair
  out.emplace_back(send_frame{frame_, x.to, std::move(*frame), name_of(content),
                              is_event ? x.from : provenance::none()});
  return true;
}

// ---- the radio

/// The duty cycles as our own clock has them now.
void peer::set_cycles(instant now) {
  energy_.clear();
  cycles_from_ = now;
  energy::cycle_key next = 0;
  const auto add = [&](const group& g, group_time first, duration period, duration length) {
    const auto turn = std::chrono::ceil<microseconds>(period);
    const auto begun = first + ((g.sync.at(now) - first) -
                                microseconds(in_us(phase(g.sync.at(now) - first, turn))));
    const auto from = g.sync.when(begun);
    energy_.set(next++, {from, g.sync.when(begun + turn) - from, length});
  };
  for (const auto& [id, g] : groups_.all()) {
    const auto& cycle = g.description.management;
    if (!g.sync.is_known())
      continue;
    if (cycle.period == duration{}) { // a group without a cycle is always awake
      energy_.set(next++, {now, 1h, 1h});
      continue;
    }
    add(g, group_time{}, cycle.period, cycle.length);
    if (config_.scout_every > 0) {
      const auto turn = config_.self.value * 7U % config_.scout_every;
      const group_time first{std::chrono::floor<microseconds>(turn * cycle.period)};
      add(g, first, config_.scout_every * cycle.period, cycle.period);
    }
    for (const auto& x : events_.all())
      if (x.group == id && x.interval > duration{})
        add(g, x.made_at, x.every * x.interval, config_.event_window);
  }
}

void peer::set_radio_state(instant now, outputs& out) {
  constexpr duration cycles_age_max = 5s;
  if (now - cycles_from_ > cycles_age_max)
    set_cycles(now);
  const bool on = !config_.saves_energy || flight_ || outbox_.has_urgent() ||
                  groups_.is_listening(now) || now < awake_until_ || energy_.is_on(now);
  if (on == is_radio_on_)
    return;
  is_radio_on_ = on;
  out.emplace_back(set_radio{on});
}

} // namespace rubicon::smepp
