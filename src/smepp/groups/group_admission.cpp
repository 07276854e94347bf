// Both sides of discovery and of the handshake by which a peer joins, or a member catches up.
#include <algorithm>
#include <cassert>

#include "core/overloads.hpp"
#include "smepp/groups/group_management.hpp"

namespace rubicon::smepp {

namespace {

constexpr duration answer_spread = 30ms; ///< between members that receive the same question

std::uint16_t in_ms(duration x) {
  return static_cast<std::uint16_t>(x / 1ms);
}

} // namespace

void group_management::on_message(mote_id from, const message& x, const opened_frame& frame,
                                  context c) {
  std::visit(
      [&](const auto& body) {
        if constexpr (requires { on(from, body, frame, c); })
          on(from, body, frame, c);
        else
          assert(false);
      },
      x);
}

// ---- discovery, the side that answers

/// The same question a moment ago; else notes it.
bool group_management::has_answered(mote_id asker, std::uint64_t nonce, instant now) {
  constexpr duration pause = 1s;
  constexpr std::size_t askers_max = 4;
  std::erase_if(answered_, [&](const answered& x) { return x.at + pause <= now; });
  if (std::ranges::any_of(answered_,
                          [&](const answered& x) { return x.asker == asker && x.nonce == nonce; }))
    return true;
  if (answered_.size() >= askers_max)
    answered_.erase(answered_.begin());
  answered_.push_back({asker, nonce, now});
  return false;
}

void group_management::on(mote_id from, const discover& x, const opened_frame& /*frame*/,
                          context c) {
  if (has_answered(from, x.nonce, c.now))
    return;
  for (auto& [id, g] : groups_) {
    const group_filter filter{x.name.empty() ? std::nullopt : std::optional(x.name), x.is_closed,
                              x.is_private, std::nullopt};
    if (g.leaving_at || !g.sync.is_known() || !filter.matches(g.description))
      continue;
    const auto& master = g.description.master;
    const bool has_key =
        master && x.proof && is_same(*x.proof, question_tag(*master, x.nonce, from));
    if (g.description.is_private && !has_key)
      continue;
    if (!c.keys.may_answer(from, c.now))
      return drop("too_many_questions");
    const auto& cycle = g.description.management;
    answer content{x.nonce,
                   id,
                   g.description.is_closed,
                   g.description.is_private,
                   static_cast<std::uint8_t>(std::min<std::size_t>(g.members.present(), 255)),
                   in_ms(cycle.period),
                   cycle.period > 0s ? in_ms(cycle.length) : std::uint16_t{0},
                   {}, // time, and the proof over it, are filled in when it is sent
                   has_key ? std::optional(tag{}) : std::nullopt,
                   to_bytes(g.description.name)};
    if (g.description.is_private)
      content.name = hidden_name(*master, from, config_.self, content);
    to_send reply{from, id, content, slot::at_once};
    reply.delay = rng_.between(duration{}, answer_spread);
    c.out.push_back(reply);
  }
}

void group_management::on(mote_id from, const answer& x, const opened_frame& /*frame*/, context c) {
  discovery_.on_answer(from, x, c.now);
}

// ---- who wants in

duration group_management::step_timeout(const management_cycle& x) const {
  return config_.step_timeout + 2 * x.period;
}

/// As far as we know it.
handshake group_management::handshake_of(const attempt& x) const {
  const auto& asked = x.members.front();
  return {config_.self, asked.who, x.proof, {}, terms_of(asked.description)};
}

group_management::attempt* group_management::attempt_with(mote_id from, group_id group,
                                                          std::uint32_t nonce) {
  const auto found = attempts_.find(group);
  const bool is_asked = found != attempts_.end() && found->second.members.front().who == from &&
                        found->second.proof.nonce == nonce;
  return is_asked ? &found->second : nullptr;
}

std::optional<key> group_management::agree(const agreement& own, const key_share& other) {
  ++counters_.agreements;
  return own.agree(other);
}

void group_management::join(group_id group, const std::optional<key>& master, context c) {
  const auto* const found = discovery_.find(group);
  const auto fail = [&](failure why) { c.out.push_back(signal{joinGroup_result{group, {}, why}}); };
  if (groups_.contains(group))
    return fail(failure::bad_argument);
  if (found == nullptr)
    return fail(failure::unknown_group);
  if (attempts_.contains(group) || attempts_.size() >= config_.joins_max ||
      groups_.size() + attempts_.size() >= config_.groups_max)
    return fail(failure::no_room);
  attempt x;
  x.proof.group = group;
  for (auto each : found->members) {
    if (master)
      each.description.master = master;
    if (each.description.is_valid()) // not closed without a key, nor open and we have one
      x.members.push_back(std::move(each));
  }
  if (x.members.empty())
    return fail(failure::wrong_master_key);
  start(std::move(x), c);
}

bool group_management::is_refuser(const group& g, mote_id who, instant now) const {
  const auto found = std::ranges::find(g.refusers, who, &group::refuser::who);
  return found != g.refusers.end() && now < found->until;
}

/// All of them together are asked once in rumour_pause_max, in the long run.
void group_management::note_refuser(group& g, mote_id who, instant now) {
  auto pause = group::refuser_pause_min;
  const auto found = std::ranges::find(g.refusers, who, &group::refuser::who);
  if (found != g.refusers.end()) {
    const auto many = static_cast<std::int64_t>(g.refusers.size());
    pause = std::min(2 * found->pause, many * config_.rumour_pause_max);
    g.refusers.erase(found);
  } else if (g.refusers.size() >= group::refusers_max) {
    g.refusers.erase(g.refusers.begin());
  }
  g.refusers.push_back({who, now + pause, pause});
}

/// @param is_rumour it need not be true that there is something to fetch
void group_management::catch_up(mote_id from, group& g, bool is_rumour, context c) {
  if (g.leaving_at || c.now < g.fetch_from || (is_rumour && is_refuser(g, from, c.now)))
    return;
  if (const auto running = attempts_.find(g.id); running != attempts_.end()) {
    // What is known takes the place of a rumour that has led to nothing yet.
    const auto& x = running->second;
    if (is_rumour || !x.is_rumour || x.is_proving || x.members.front().who == from)
      return;
    attempts_.erase(running);
  }
  if (attempts_.size() >= config_.joins_max)
    return;
  g.fetch_from = c.now + config_.fetch_pause;
  attempt x;
  x.proof.group = g.id;
  x.members.push_back({from, g.description, true, {}, c.now});
  x.is_member = x.proof.is_member = true;
  x.is_rumour = is_rumour;
  start(std::move(x), c);
}

void group_management::start(attempt x, context c) {
  const auto group = x.proof.group;
  const auto nonce = c.keys.unique();
  x.proof.nonce = static_cast<std::uint32_t>(nonce.value_or(0));
  x.proof.transducers = config_.transducers;
  x.proof.identity = identity_share_;
  x.is_proving = false;
  x.tries = x.challenges = 0;
  auto& running = attempts_[group] = std::move(x);
  if (!nonce)
    return finish(group, failure::no_room, c);
  go_on(running, failure::no_answer, c);
}

void group_management::send_step(attempt& x, context c) {
  message step = smepp::join{x.proof.group, x.proof.nonce};
  if (x.is_proving)
    step = x.proof;
  // A member that has sent just now is awake; it need not be when we try again.
  const bool at_once = x.is_rumour || (x.tries == 1 && (x.is_member || x.is_proving));
  to_send sent{x.members.front().who, x.proof.group, step,
               at_once ? slot::at_once : slot::management};
  sent.token = step_token | x.proof.group.value;
  c.out.push_back(sent);
}

/// The present step once more, or the next member, or the end.
void group_management::go_on(attempt& x, failure why, context c) {
  constexpr unsigned advised_tries = 2; // after a refusal that need not be authentic
  const auto tries = x.advised ? advised_tries : config_.step_tries;
  if (x.tries < tries && why == failure::no_answer) {
    ++x.tries;
    const auto& cycle = x.members.front().description.management;
    const auto* const g = x.is_rumour ? find(x.proof.group) : nullptr;
    x.due = c.now + (g != nullptr ? rumour_wait(*g) : step_timeout(cycle));
    return send_step(x, c);
  }
  if (x.members.size() <= 1)
    return finish(x.proof.group, x.advised && why == failure::no_answer ? *x.advised : why, c);
  auto again = x;
  again.members.erase(again.members.begin());
  start(std::move(again), c);
}

bool group_management::on_step_sent(group_id group, bool acked, context c) {
  const auto found = attempts_.find(group);
  if (found == attempts_.end() || !found->second.is_member)
    return false;
  if (!acked && found->second.tries > 1) // it is not there
    go_on(found->second, failure::not_admitted, c);
  return acked;
}

void group_management::finish(group_id group, std::optional<failure> error, context c) {
  const auto found = attempts_.find(group);
  const auto ended = std::move(found->second);
  attempts_.erase(found);
  if (!error)
    return;
  if (!ended.is_member)
    c.out.push_back(signal{joinGroup_result{group, {}, error}});
  else if (auto* const g = find(group))
    note_refuser(*g, ended.members.front().who, c.now);
}

/// Now, not before: who has no answer computes nothing.
void group_management::prove(attempt& x, context c) {
  if (x.challenges == 1) {
    x.own = agreement::make(secrets_);
    x.proof.share = x.own.share();
    ++counters_.agreements;
  }
  const auto& description = x.members.front().description;
  x.proof.proof = join_tag(credential_of(description, c.keys.network_keys()), handshake_of(x));
  x.is_proving = true;
  x.tries = 0;
  go_on(x, failure::no_answer, c);
}

void group_management::on(mote_id from, const join_challenge& x, const opened_frame& /*frame*/,
                          context c) {
  constexpr unsigned challenges_max = 4; // a cookie may have become old, and some are false
  auto* const mine = attempt_with(from, x.group, x.nonce);
  if (mine == nullptr)
    return drop("not_asked");
  if (mine->is_proving && mine->proof.cookie == x.cookie)
    return;
  if (mine->challenges >= challenges_max)
    return drop("too_many_challenges");
  ++mine->challenges;
  mine->proof.cookie = x.cookie;
  prove(*mine, c);
}

void group_management::on(mote_id from, const join_refuse& x, const opened_frame& /*frame*/,
                          context c) {
  auto* const mine = attempt_with(from, x.group, x.nonce);
  if (mine == nullptr || !mine->is_proving)
    return drop("not_asked");
  const auto credential = credential_of(mine->members.front().description, c.keys.network_keys());
  if (is_same(x.mac, refuse_tag(credential, handshake_of(*mine), x.why)))
    return go_on(*mine, x.why, c);
  drop("unproven_refusal");
  mine->advised = failure::wrong_master_key; // else it would have a MAC
}

void group_management::on(mote_id from, const join_accept& x, const opened_frame& frame,
                          context c) {
  auto* const found = attempt_with(from, x.group, x.nonce);
  if (found == nullptr || !found->is_proving || !agreements_.take(c.now))
    return drop("not_asked");
  const auto mine = *found;
  auto with = handshake_of(mine);
  with.share = x.share;
  const auto agreed = agree(mine.own, x.share);
  const auto with_identity = agree(identity_, x.share);
  const auto& description = mine.members.front().description;
  const auto session = agreed && with_identity
                           ? unwrap(accept_key(credential_of(description, c.keys.network_keys()),
                                               with, *agreed, *with_identity),
                                    x.keys, carrier_of(x))
                           : std::nullopt;
  if (!session)
    return drop("wrong_wrap");
  finish(x.group, std::nullopt, c);
  if (auto* const g = find(x.group)) {
    caught_up(*g, from, *session, x, c);
    c.keys.believe(from, x.group, session->id, frame.counter);
  } else {
    enter(mine, *session, x, frame.counter, c);
  }
}

void group_management::enter(const attempt& x, const session_keys& session,
                             const join_accept& accept, std::uint64_t counter, context c) {
  const auto& description = x.members.front().description;
  auto& g = add(x.proof.group, description, c);
  g.ring.learn(session, c.now + std::chrono::milliseconds(accept.keys.send_in_ms), c.now);
  g.sync.adopt(accept.time, c.now);
  g.incomplete = group::incomplete_join{c.now + 2 * step_timeout(description.management),
                                        accept.members, accept.subscriptions};
  changed(g, c);
  c.keys.believe(x.members.front().who, g.id, session.id, counter);
}

void group_management::caught_up(group& g, mote_id from, const session_keys& session,
                                 const join_accept& accept, context c) {
  const bool is_news =
      g.ring.learn(session, c.now + std::chrono::milliseconds(accept.keys.send_in_ms), c.now);
  if (is_news) {
    g.refresh_at.reset();
    g.is_best_fetched = true;
  }
  if (is_news || g.is_returning) {
    g.refusers.clear();
    g.guess_pause = group::refuser_pause_min;
  } else {
    note_refuser(g, from, c.now);
  }
  ++counters_.caught_up;
  if (!g.sync.is_known())
    g.sync.adopt(accept.time, c.now);
  g.is_returning = false;
  changed(g, c);
  if (is_news)
    g.sync.hurry(c.now); // our stamps announce the new keys to others on our side
}

// ---- who lets in

/// Cookies are good for this turn and the next.
std::uint64_t group_management::turn(const group& g, instant now) const {
  const auto length = config_.step_tries * step_timeout(g.description.management);
  return static_cast<std::uint64_t>(now.time_since_epoch() / length);
}

void group_management::ask_for_proof(mote_id from, const smepp::join& x, const group& g,
                                     context c) {
  if (!c.keys.may_answer(from, c.now))
    return drop("too_many_joins");
  c.out.push_back(
      to_send{from, x.group,
              join_challenge{x.group, x.nonce, cookie_of(cookie_key_, from, x, turn(g, c.now))},
              slot::at_once});
}

bool group_management::has_cookie(mote_id from, const join_proof& x, const group& g,
                                  instant now) const {
  const auto present = turn(g, now);
  const auto is_of = [&](std::uint64_t t) {
    return is_same(x.cookie, cookie_of(cookie_key_, from, {x.group, x.nonce}, t));
  };
  return is_of(present) || is_of(present - 1);
}

void group_management::on(mote_id from, const smepp::join& x, const opened_frame& /*frame*/,
                          context c) {
  const auto* const g = find(x.group);
  if (g == nullptr || g->leaving_at || !g->sync.is_known() || g->is_returning)
    return drop("no_member");
  ask_for_proof(from, x, *g, c);
}

void group_management::refuse(mote_id joiner, const join_proof& x, failure why, tag mac,
                              context c) {
  c.out.push_back(to_send{joiner, x.group, join_refuse{x.group, x.nonce, why, mac}, slot::at_once});
}

void group_management::on(mote_id from, const join_proof& x, const opened_frame& frame, context c) {
  auto* const g = find(x.group);
  if (g == nullptr || g->leaving_at || !g->sync.is_known() || g->is_returning)
    return drop("no_member");
  if (!has_cookie(from, x, *g, c.now)) {
    drop("old_cookie");
    return ask_for_proof(from, {x.group, x.nonce}, *g, c);
  }
  const auto before = std::ranges::find_if(admitted_, [&](const admitted& each) {
    return each.joiner == from && each.group == x.group && each.nonce == x.nonce;
  });
  if (before != admitted_.end())
    return welcome(*g, *before, c);
  const handshake with{from, config_.self, x, {}, terms_of(g->description)};
  const auto mine = credential(*g, c.keys);
  if (!is_same(x.proof, join_tag(mine, with))) {
    drop("wrong_master_key");
    if (c.keys.may_answer(from, c.now))
      refuse(from, x, failure::wrong_master_key, {}, c);
    return;
  }
  const auto why = !config_.admits ? failure::not_admitted : failure::group_full;
  if (!config_.admits || (g->members.find(from) == nullptr && !g->members.has_room()))
    return refuse(from, x, why, refuse_tag(mine, with, why), c);
  if (!agreements_.take(c.now))
    return drop("too_many_joins");
  admit(*g, with, frame.counter, c);
}

/// Who is a member already lacks keys, or the answer to its proof: neither is a reason for others.
/// It has to be the member that its identity shows; any other is announced to all.
void group_management::note_joiner(group& g, const handshake& with, context c) {
  const auto& x = with.proof;
  const auto identity = short_hash(x.identity);
  const auto* const known = g.members.find(with.joiner);
  const bool is_there = known != nullptr && !known->has_left && known->identity == identity;
  const bool is_repeat =
      is_there && known->who.transducers == x.transducers &&
      std::ranges::any_of(g.members_sent, [&](const auto& each) {
        return each.first == with.joiner && each.second + config_.members_pause > c.now;
      });
  if ((is_there && x.is_member) || is_repeat)
    return;
  if (g.ring.best_from() <= c.now)
    make_keys(g, false, c);
  const auto stamp = static_cast<std::uint16_t>((known != nullptr ? known->stamp : 0) + 1);
  learn(g, {{with.joiner, x.transducers}, stamp, false, identity}, true, c);
  ++counters_.admitted;
}

void group_management::admit(group& g, const handshake& asked, std::uint64_t counter, context c) {
  auto with = asked;
  const auto own = agreement::make(secrets_);
  with.share = own.share();
  ++counters_.agreements;
  const auto agreed = agree(own, with.proof.share);
  const auto with_identity = agree(own, with.proof.identity);
  if (!agreed || !with_identity)
    return drop("bad_share");
  note_joiner(g, with, c);
  const auto joiner = with.joiner;
  const auto best = g.ring.best().id;
  c.keys.believe(joiner, g.id, best, counter);
  if (admitted_.size() >= admitted_max)
    admitted_.erase(admitted_.begin());
  admitted_.push_back({joiner,
                       g.id,
                       with.proof.nonce,
                       accept_key(credential(g, c.keys), with, *agreed, *with_identity),
                       with.share,
                       {}});
  welcome(g, admitted_.back(), c);
  for (auto& list : g.members.lists()) {
    to_send introduction{joiner, g.id, std::move(list), slot::at_once};
    introduction.under = best;
    c.out.push_back(introduction);
  }
  std::erase_if(g.members_sent, [&](const auto& each) { return each.first == joiner; });
  g.members_sent.emplace_back(joiner, c.now);
  g.sync.hurry(c.now);
  c.out.push_back(newcomer{g.id, joiner, best});
}

void group_management::welcome(group& g, admitted& x, context c) {
  constexpr duration pause = 250ms; // who repeats its proof has not received this
  if (x.sent != instant{} && c.now < x.sent + pause)
    return;
  x.sent = c.now;
  const auto& best = g.ring.best();
  to_send sent{
      x.joiner, g.id,
      join_accept{g.id,
                  x.nonce,
                  x.share,
                  wrap(x.under, best, g.ring.best_from() - c.now),
                  static_cast<std::uint8_t>(std::min<std::size_t>(g.members.present(), 255)),
                  0,   // so many subscriptions, and
                  {}}, // the time: filled in when it is sent
      slot::at_once};
  sent.bound_under = x.under;
  c.out.push_back(sent);
}

bool group_management::complete_join(group_id id, std::size_t subscriptions, instant now) {
  auto* const g = find(id);
  if (g == nullptr || !g->incomplete)
    return false;
  const auto& x = *g->incomplete;
  const bool is_complete = g->members.present() >= x.members && subscriptions >= x.subscriptions;
  if (!is_complete && now < x.until)
    return false;
  g->incomplete.reset();
  return true;
}

} // namespace rubicon::smepp
