// Both sides of discovery and of the handshake by which a peer joins, or a member catches up.
#include <algorithm>
#include <cassert>

#include "core/overloads.hpp"
#include "smepp/group_management.hpp"

namespace rubicon::smepp {

namespace {

constexpr duration answer_spread = 30ms; ///< members that hear the same question

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
bool group_management::has_answered(mote_id asker, std::uint32_t nonce, instant now) {
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
    if (g.description.is_private &&
        (!x.proof || !is_same(*x.proof, discovery_tag(*master, x.nonce, from, network_level))))
      continue;
    if (!answers_.take(c.now))
      return drop("too_many_questions");
    const auto& cycle = g.description.management;
    answer told{x.nonce,
                id,
                g.description.is_closed,
                g.description.is_private,
                static_cast<std::uint8_t>(std::min<std::size_t>(g.members.present(), 255)),
                in_ms(cycle.period),
                cycle.period > 0s ? in_ms(cycle.length) : std::uint16_t{0},
                {}, // the time is filled in when it is sent
                {},
                to_bytes(g.description.name)};
    if (g.description.is_private) {
      told.proof = discovery_tag(*master, x.nonce, config_.self, id);
      told.name = hidden_name(*master, x.nonce, config_.self, told.name);
    }
    to_send reply{from, id, told, slot::at_once};
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

void group_management::join(group_id group, const std::optional<key>& master, context c) {
  const auto* const found = discovery_.find(group);
  const auto fail = [&](failure why) { c.out.push_back(signal{joinGroup_result{group, {}, why}}); };
  if (groups_.contains(group))
    return fail(failure::bad_argument);
  if (found == nullptr || found->members.empty())
    return fail(failure::unknown_group);
  if (attempts_.contains(group) || attempts_.size() >= config_.joins_max ||
      groups_.size() + attempts_.size() >= config_.groups_max)
    return fail(failure::no_room);
  attempt x;
  x.description = found->description;
  if (master)
    x.description.master = master;
  if (!x.description.is_valid())
    return fail(failure::wrong_master_key); // closed, and no key
  x.with = {group, config_.self, found->members.front()};
  x.next.assign(found->members.begin() + 1, found->members.end());
  start(std::move(x), c);
}

void group_management::catch_up(mote_id from, group& g, context c) {
  if (g.leaving_at || c.now < g.fetch_from || attempts_.contains(g.id) ||
      attempts_.size() >= config_.joins_max)
    return;
  g.fetch_from = c.now + config_.fetch_pause;
  attempt x;
  x.description = g.description;
  x.with = {g.id, config_.self, from};
  x.is_member = true;
  start(std::move(x), c);
}

void group_management::start(attempt x, context c) {
  x.with.nonce = c.keys.unique();
  x.own = agreement::make(rng_);
  x.with.share = x.own.share();
  x.is_proving = false;
  x.tries = 0;
  const auto group = x.with.group;
  attempts_[group] = std::move(x);
  go_on(attempts_.at(group), failure::no_answer, c);
}

void group_management::send_step(const attempt& x, context c) {
  const auto& with = x.with;
  message step = smepp::join{with.group, with.nonce, config_.transducers, x.is_member, with.share};
  if (x.is_proving)
    step = join_proof{with.group, with.nonce, with.member_nonce,
                      join_tag(credential_of(x.description, c.keys.network_keys()), with,
                               config_.transducers, x.is_member)};
  // A member that we have heard just now is awake; it need not be when we try again.
  const bool at_once = x.tries == 1 && (x.is_member || x.is_proving);
  c.out.push_back(
      to_send{with.member, with.group, step, at_once ? slot::at_once : slot::management});
}

/// The present step once more, or the next member, or the end.
void group_management::go_on(attempt& x, failure why, context c) {
  if (x.tries < config_.step_tries && why == failure::no_answer) {
    ++x.tries;
    x.due = c.now + step_timeout(x.description.management);
    return send_step(x, c);
  }
  if (x.next.empty() || why == failure::wrong_master_key)
    return finish(x.with.group, why, c);
  auto again = x;
  again.with.member = again.next.front();
  again.next.erase(again.next.begin());
  start(std::move(again), c);
}

void group_management::finish(group_id group, std::optional<failure> error, context c) {
  const auto found = attempts_.find(group);
  const bool is_member = found->second.is_member;
  attempts_.erase(found);
  if (error && !is_member)
    c.out.push_back(signal{joinGroup_result{group, {}, error}});
}

void group_management::on(mote_id from, const join_challenge& x, const opened_frame& /*frame*/,
                          context c) {
  const auto found = attempts_.find(x.group);
  if (found == attempts_.end() || found->second.with.member != from ||
      found->second.with.nonce != x.nonce)
    return drop("not_asked");
  auto& mine = found->second;
  if (mine.is_proving && mine.with.member_nonce == x.member_nonce)
    return;
  mine.with.member_nonce = x.member_nonce;
  mine.with.member_share = x.share;
  mine.is_proving = true;
  mine.tries = 0;
  go_on(mine, failure::no_answer, c);
}

void group_management::on(mote_id from, const join_refuse& x, const opened_frame& /*frame*/,
                          context c) {
  const auto found = attempts_.find(x.group);
  if (found == attempts_.end() || found->second.with.member != from ||
      found->second.with.nonce != x.nonce)
    return drop("not_asked");
  go_on(found->second, x.why, c);
}

void group_management::on(mote_id from, const join_accept& x, const opened_frame& frame,
                          context c) {
  const auto found = attempts_.find(x.group);
  if (found == attempts_.end() || found->second.with.member != from ||
      found->second.with.nonce != x.nonce || !found->second.is_proving)
    return drop("not_asked");
  const auto mine = found->second;
  const auto agreed = mine.own.agree(mine.with.member_share);
  const auto session =
      agreed ? unwrap(accept_key(credential_of(mine.description, c.keys.network_keys()), mine.with,
                                 *agreed),
                      x.keys)
             : std::nullopt;
  if (!session)
    return drop("wrong_wrap");
  finish(x.group, std::nullopt, c);
  if (auto* const g = find(x.group)) {
    caught_up(*g, *session, x, c);
    c.keys.believe(from, x.group, frame.counter);
  } else {
    enter(mine, *session, x, frame.counter, c);
  }
}

void group_management::enter(const attempt& x, const session_keys& session,
                             const join_accept& accept, std::uint32_t counter, context c) {
  auto& g = add(x.with.group, x.description, c);
  g.ring.learn(session, c.now + std::chrono::milliseconds(accept.keys.send_in_ms), c.now);
  g.sync.adopt(accept.time, c.now);
  g.settling_in = group::settling{c.now + 2 * step_timeout(x.description.management),
                                  accept.members, accept.subscriptions};
  changed(g, c);
  c.keys.believe(x.with.member, g.id, counter);
}

void group_management::caught_up(group& g, const session_keys& session, const join_accept& accept,
                                 context c) {
  const bool is_news =
      g.ring.learn(session, c.now + std::chrono::milliseconds(accept.keys.send_in_ms), c.now);
  if (is_news) {
    g.refresh_at.reset();
    g.is_best_fetched = true;
  }
  if (is_news || g.is_returning)
    g.rumour_pause = group::rumour_pause_min;
  ++counters_.caught_up;
  if (!g.sync.is_known())
    g.sync.adopt(accept.time, c.now);
  g.is_returning = false;
  changed(g, c);
  if (is_news)
    g.sync.hurry(c.now); // our stamps tell others on our side that there is something to fetch
}

// ---- who lets in

void group_management::on(mote_id from, const smepp::join& x, const opened_frame& /*frame*/,
                          context c) {
  auto* const g = find(x.group);
  if (g == nullptr || g->leaving_at || !g->sync.is_known() || g->is_returning)
    return drop("no_member");
  auto found = std::ranges::find_if(applicants_, [&](const applicant& each) {
    return each.with.joiner == from && each.with.group == x.group;
  });
  const bool is_known = found != applicants_.end() && found->with.nonce == x.nonce;
  if (!is_known) {
    if (found != applicants_.end())
      applicants_.erase(found);
    if (applicants_.size() >= config_.joins_max || !challenges_.take(c.now))
      return drop("too_many_joins");
    const auto own = agreement::make(rng_);
    applicants_.push_back(
        {{x.group, from, config_.self, x.nonce, c.keys.unique(), x.share, own.share()},
         own,
         x.transducers,
         x.is_member,
         c.now + config_.step_tries * step_timeout(g->description.management)});
    found = applicants_.end() - 1;
  }
  c.out.push_back(
      to_send{from, x.group,
              join_challenge{x.group, x.nonce, found->with.member_nonce, found->with.member_share},
              slot::at_once});
}

void group_management::refuse(const applicant& x, failure why, context c) {
  c.out.push_back(to_send{x.with.joiner, x.with.group, join_refuse{x.with.group, x.with.nonce, why},
                          slot::at_once});
}

void group_management::on(mote_id from, const join_proof& x, const opened_frame& frame, context c) {
  auto* const g = find(x.group);
  const auto found = std::ranges::find_if(applicants_, [&](const applicant& each) {
    return each.with.joiner == from && each.with.group == x.group && each.with.nonce == x.nonce &&
           each.with.member_nonce == x.member_nonce;
  });
  if (g == nullptr || g->leaving_at || found == applicants_.end())
    return drop("not_asked");
  const auto who = *found;
  if (!is_same(x.proof,
               join_tag(credential(*g, c.keys), who.with, who.transducers, who.is_member))) {
    applicants_.erase(found);
    drop("wrong_master_key");
    return refuse(who, failure::wrong_master_key, c);
  }
  if (!config_.admits)
    return refuse(who, failure::not_admitted, c);
  if (g->members.find(from) == nullptr && !g->members.has_room())
    return refuse(who, failure::group_full, c);
  admit(*g, who, frame.counter, c);
}

void group_management::admit(group& g, const applicant& x, std::uint32_t counter, context c) {
  const auto joiner = x.with.joiner;
  const auto agreed = x.own.agree(x.with.share);
  if (!agreed)
    return drop("bad_share");
  const auto* const known = g.members.find(joiner);
  // Who is a member already lacks keys, or the answer to its proof: neither is a reason for others.
  const bool is_there = known != nullptr && !known->has_left;
  const bool is_repeat = is_there && known->who.transducers == x.transducers &&
                         std::ranges::any_of(g.told, [&](const auto& each) {
                           return each.first == joiner && each.second + config_.told_pause > c.now;
                         });
  if (!(is_there && x.is_member) && !is_repeat) {
    if (g.ring.best_from() <= c.now)
      make_keys(g, false, c);
    const auto stamp = static_cast<std::uint16_t>((known != nullptr ? known->stamp : 0) + 1);
    learn(g, {{joiner, x.transducers}, stamp, false}, true, c);
    ++counters_.admitted;
  }
  c.keys.believe(joiner, g.id, counter);
  const auto& best = g.ring.best();
  join_accept welcome{
      g.id,
      x.with.nonce,
      wrap(accept_key(credential(g, c.keys), x.with, *agreed), best, g.ring.best_from() - c.now),
      static_cast<std::uint8_t>(std::min<std::size_t>(g.members.present(), 255)),
      0,   // so many subscriptions, and
      {}}; // the time: filled in when it is sent
  c.out.push_back(to_send{joiner, g.id, welcome, slot::at_once});
  for (auto& list : g.members.lists()) {
    to_send introduction{joiner, g.id, std::move(list), slot::at_once};
    introduction.under = best.id;
    c.out.push_back(introduction);
  }
  std::erase_if(g.told, [&](const auto& each) { return each.first == joiner; });
  g.told.emplace_back(joiner, c.now);
  g.sync.hurry(c.now);
  c.out.push_back(newcomer{g.id, joiner, best.id});
}

bool group_management::settle(group_id id, std::size_t subscriptions, instant now) {
  auto* const g = find(id);
  if (g == nullptr || !g->settling_in)
    return false;
  const auto& x = *g->settling_in;
  const bool is_complete = g->members.present() >= x.members && subscriptions >= x.subscriptions;
  if (!is_complete && now < x.until)
    return false;
  g->settling_in.reset();
  return true;
}

} // namespace rubicon::smepp
