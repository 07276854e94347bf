#include "smepp/groups/group_management.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

namespace rubicon::smepp {

namespace {

constexpr std::size_t members_sent_max = 8;

} // namespace

group_management::group_management(group_config config, random_stream rng, randomness secrets,
                                   const agreement& identity)
    : config_(config), rng_(rng), secrets_(std::move(secrets)), identity_(identity),
      identity_share_(identity.share()) {
  std::array<std::uint8_t, key::size> octets{};
  secrets_.fill(octets);
  cookie_key_ = key(octets);
  config_.discovery.self = config.self;
  config_.sync.self = config.self;
  discovery_ = discovery(config_.discovery);
}

group& group_management::add(group_id id, const group_description& x, context c) {
  group g;
  g.id = id;
  g.description = x;
  g.ring = session_ring(config_.key_grace);
  g.members = member_table(config_.members_max);
  g.sync = weak_sync(config_.sync, random_stream(rng_.next()), c.now);
  return groups_[id] = std::move(g);
}

std::variant<group_id, failure> group_management::create(const group_description& x, context c) {
  if (!x.is_valid())
    return failure::bad_argument;
  const auto id = id_of(x.name, config_.self);
  if (groups_.contains(id) || attempts_.contains(id))
    return failure::name_taken;
  if (groups_.size() + attempts_.size() >= config_.groups_max)
    return failure::no_room;
  auto& g = add(id, x, c);
  g.sync.begin(c.now);
  g.members.learn(own_entry(1));
  g.ring.learn(make_session(credential(g, c.keys), {1, config_.self}, secrets_), c.now, c.now);
  changed(g, c);
  return id;
}

void group_management::ask(const group_filter& x, context c) {
  discovery_.ask(x, c.keys, c.now);
}

std::optional<failure> group_management::leave(group_id group, context c) {
  auto* const g = find(group);
  if (g == nullptr || g->leaving_at)
    return failure::not_a_member;
  const auto* const known = g->members.find(config_.self);
  const auto stamp = static_cast<std::uint16_t>((known != nullptr ? known->stamp : 0) + 1);
  auto gone = own_entry(stamp);
  gone.has_left = true;
  g->members.learn(gone);
  to_send news{broadcast_mote, group, member_left{gone}};
  news.copies = config_.flood_copies;
  c.out.push_back(news);
  g->leaving_at = c.now + 2 * g->description.management.period + config_.step_timeout;
  return std::nullopt;
}

std::optional<failure> group_management::refresh_keys(group_id group, context c) {
  auto* const g = find(group);
  if (g == nullptr || g->leaving_at)
    return failure::not_a_member;
  make_keys(*g, false, c);
  return std::nullopt;
}

void group_management::restore(const stored_group& x, context c) {
  if (groups_.size() >= config_.groups_max || groups_.contains(x.id))
    return drop("no_room");
  auto& g = add(x.id, x.description, c);
  g.ring.learn(x.session, c.now, c.now);
  g.members.learn(own_entry(x.stamp));
  g.neighbours = x.neighbours;
  g.is_returning = true;
  changed(g, c);
}

// ---- keys

void group_management::changed(group& g, context c) {
  c.keys.set_group(g.id, g.ring.accepted());
  c.out.push_back(keys_changed{g.id});
}

duration group_management::activation_time(const group& g, bool by_handshakes) const {
  const auto time =
      config_.activation + config_.activation_periods * g.description.management.period;
  return by_handshakes ? config_.fetching_factor * time : time;
}

void group_management::make_keys(group& g, bool somebody_left, context c) {
  const auto before = g.ring.sending(c.now);
  const auto pending = g.ring.best().id; // all that who has just joined has
  const session_id id{static_cast<std::uint16_t>(g.ring.best().id.generation + 1), config_.self};
  g.ring.learn(make_session(credential(g, c.keys), id, secrets_),
               c.now + activation_time(g, somebody_left), c.now);
  g.refresh_at.reset();
  ++counters_.keys_made;
  changed(g, c);
  const bool is_secret_from_some = std::exchange(g.is_best_fetched, somebody_left);
  if (somebody_left)
    return g.sync.hurry(c.now); // our stamps say that there is something to fetch
  if (!is_secret_from_some)
    announce(g, before, config_.flood_copies, c);
  if (pending != before || is_secret_from_some)
    announce(g, pending, config_.flood_copies, c);
}

/// Sends the best pair to those who have the pair `under`.
void group_management::announce(const group& g, session_id under, unsigned copies, context c) {
  const auto* const old = g.ring.find(under);
  if (old == nullptr || under == g.ring.best().id)
    return;
  to_send news{broadcast_mote, g.id,
               key_refresh{wrap(refresh_key(credential(g, c.keys), old->keys), g.ring.best(),
                                g.ring.best_from() - c.now)}};
  news.under = under;
  news.copies = copies;
  c.out.push_back(news);
}

void group_management::on(mote_id /*from*/, const key_refresh& x, const opened_frame& frame,
                          context c) {
  auto* const g = find(frame.group);
  if (g == nullptr || g->leaving_at)
    return drop("no_member");
  if (g->ring.find(x.keys.id) != nullptr)
    return;
  const auto* const old = g->ring.find(frame.session);
  const auto session = old == nullptr
                           ? std::nullopt
                           : unwrap(refresh_key(credential(*g, c.keys), old->keys), x.keys);
  if (!session)
    return drop("wrong_wrap");
  const auto from = c.now + std::chrono::milliseconds(x.keys.send_in_ms);
  const bool is_best = g->ring.learn(*session, from, c.now);
  ++counters_.keys_learned;
  changed(*g, c);
  if (!is_best)
    return g->sync.hurry(c.now); // who made a worse pair sees that there is a better one
  g->is_best_fetched = false;
  announce(*g, frame.session, config_.flood_copies, c); // others under these keys may lack it
}

/// The key number says it, in clear: it is a reason to ask a neighbour that is there, and now and
/// then somebody else.
void group_management::on_foreign_keys(mote_id from, group_id group, context c) {
  auto* const g = find(group);
  if (g == nullptr || is_refuser(*g, from, c.now) || g->rumours.size() >= group::rumours_max ||
      std::ranges::any_of(g->rumours, [&](const auto& x) { return x.from == from; }))
    return;
  // Its radio is on now, and will be again a number of periods later; ours may go by another time.
  const auto wait = g->is_returning ? duration{} : rumour_wait(*g);
  const auto due = c.now + wait;
  if (std::ranges::find(g->neighbours, from) == g->neighbours.end()) {
    if (c.now < g->guess_from)
      return;
    g->guess_from = due + g->guess_pause;
    g->guess_pause = std::min(2 * g->guess_pause, config_.rumour_pause_max);
  }
  g->rumours.push_back({from, g->ring.best().id, due});
  if (g->is_returning)
    check_rumours(*g, c);
}

duration group_management::rumour_wait(const group& g) const {
  const auto period = g.description.management.period;
  if (period == duration{})
    return config_.rumour_wait;
  return period * ((config_.rumour_wait + 2 * period) / period + 1);
}

void group_management::check_rumours(group& g, context c) {
  for (auto& x : g.rumours)
    if (x.due <= c.now && x.best == g.ring.best().id && attempts_.contains(g.id))
      x.due += rumour_wait(g); // its turn comes
  const auto due = [&](const group::rumour& x) { return x.due <= c.now; };
  const auto found = std::ranges::find_if(g.rumours, due);
  if (found == g.rumours.end())
    return;
  const auto x = *found;
  g.rumours.erase(found);
  if (x.best == g.ring.best().id)
    catch_up(x.from, g, true, c);
}

void group_management::on_member_frame(mote_id from, group_id group, bool is_proven, context c) {
  auto* const g = find(group);
  if (g == nullptr)
    return;
  if (is_proven) {
    std::erase(g->neighbours, from);
    g->neighbours.insert(g->neighbours.begin(), from);
    if (g->neighbours.size() > stored_group::neighbours_max)
      g->neighbours.pop_back();
  }
  if (g->is_returning)
    catch_up(from, *g, true, c);
}

// ---- members

void group_management::learn(group& g, const member& x, bool spread, context c) {
  if (x.who.peer == config_.self) {
    const auto* const own = g.members.find(config_.self);
    const bool is_wrong = x.has_left || x.who.transducers != config_.transducers ||
                          x.identity != own_entry(0).identity;
    if (!is_wrong || g.leaving_at) {
      g.members.learn(x);
      return;
    }
    // Somebody remembers a former life of ours, or has come in under our name.
    const auto stamp = std::max(x.stamp, own != nullptr ? own->stamp : std::uint16_t{0});
    const auto true_one = own_entry(static_cast<std::uint16_t>(stamp + 1));
    g.members.learn(true_one);
    to_send news{broadcast_mote, g.id, member_joined{true_one}};
    news.copies = config_.flood_copies;
    c.out.push_back(news);
    return;
  }
  const auto change = g.members.learn(x);
  if (change == member_table::change::no_room)
    return drop("no_room");
  const bool is_other = change == member_table::change::replaced;
  if ((change == member_table::change::joined || is_other) && !g.incomplete)
    c.out.push_back(signal{peerJoined{g.id, x.who}}); // else the list is the result
  if (change == member_table::change::left)
    c.out.push_back(signal{peerLeft{x.who.peer, g.id}});
  if (change == member_table::change::left || is_other)
    on_left(g, c); // also who was there under that name before
  if (change == member_table::change::none || !spread)
    return;
  to_send news{broadcast_mote, g.id, member_joined{x}};
  if (x.has_left)
    news.content = member_left{x};
  news.copies = config_.flood_copies;
  c.out.push_back(news);
}

/// Somebody knows keys that it must not know for longer.
void group_management::on_left(group& g, context c) {
  const auto rank = static_cast<std::int64_t>(g.members.rank(config_.self));
  if (!g.refresh_at)
    g.refresh_at = c.now + rank * activation_time(g, true);
}

member group_management::own_entry(std::uint16_t stamp) const {
  return {{config_.self, config_.transducers}, stamp, false, short_hash(identity_share_)};
}

void group_management::on(mote_id /*from*/, const member_joined& x, const opened_frame& frame,
                          context c) {
  if (auto* const g = find(frame.group))
    learn(*g, x.who, true, c);
}

void group_management::on(mote_id /*from*/, const member_left& x, const opened_frame& frame,
                          context c) {
  if (auto* const g = find(frame.group))
    learn(*g, x.who, true, c);
}

void group_management::on(mote_id /*from*/, const member_list& x, const opened_frame& frame,
                          context c) {
  if (auto* const g = find(frame.group))
    for (const auto& each : x.all)
      learn(*g, each, false, c);
}

/// All we know of the members, to one neighbour, unless they were sent to it just now.
void group_management::send_members(mote_id to, group& g, context c) {
  std::erase_if(g.members_sent,
                [&](const auto& x) { return x.second + config_.members_pause <= c.now; });
  const bool was_sent =
      std::ranges::any_of(g.members_sent, [&](const auto& x) { return x.first == to; });
  if (was_sent || g.members_sent.size() >= members_sent_max)
    return;
  g.members_sent.emplace_back(to, c.now);
  for (auto& list : g.members.lists())
    c.out.push_back(to_send{to, g.id, std::move(list)});
}

// ---- time

void group_management::on_stamp(mote_id from, const sync_stamp& x, group_id group, instant at,
                                context c) {
  auto* const g = find(group);
  if (g == nullptr)
    return;
  static_cast<void>(g->sync.on_stamp(from, x, at));
  if (is_better(x.best, g->ring.best().id))
    catch_up(from, *g, false, c);
  if (x.digest != g->members.digest())
    send_members(from, *g, c);
}

void group_management::on_time(context c) {
  discovery_.on_time(c.out, c.now);
  std::vector<group_id> due;
  for (const auto& [id, x] : attempts_)
    if (x.due <= c.now)
      due.push_back(id);
  for (const auto id : due)
    go_on(attempts_.at(id), failure::no_answer, c);

  for (auto at = groups_.begin(); at != groups_.end();) {
    auto& g = at->second;
    if (g.leaving_at && *g.leaving_at <= c.now) {
      const auto id = at->first;
      attempts_.erase(id);
      at = groups_.erase(at);
      c.keys.remove_group(id);
      c.out.push_back(group_gone{id});
      c.out.push_back(keys_changed{id});
      c.out.push_back(signal{peerLeft{config_.self, id}});
      continue;
    }
    ++at;
    if (g.ring.on_time(c.now))
      changed(g, c);
    check_rumours(g, c);
    if (const auto due_at = next_keys(g); due_at && *due_at <= c.now)
      make_keys(g, g.refresh_at && *g.refresh_at <= c.now, c);
    if (g.sync.on_time(c.now)) {
      sync_stamp stamp; // the peer fills in the time when it is sent
      c.out.push_back(to_send{broadcast_mote, g.id, stamp});
    }
    if (g.is_returning && g.sync.is_root())
      g.is_returning = false; // no member is there
  }
}

/// When we are to make new session keys.
std::optional<instant> group_management::next_keys(const group& g) const {
  if (g.leaving_at || g.is_returning)
    return std::nullopt;
  const auto rank = static_cast<std::int64_t>(g.members.rank(config_.self));
  return earliest(g.ring.best_from() + config_.key_period + rank * config_.rank_pause,
                  g.refresh_at);
}

std::optional<instant> group_management::deadline() const {
  auto first = discovery_.deadline();
  for (const auto& [id, x] : attempts_)
    first = earliest(first, x.due);
  for (const auto& [id, g] : groups_) {
    first = earliest(first, g.leaving_at);
    for (const auto& x : g.rumours)
      first = earliest(first, x.due);
    first = earliest(first, g.ring.deadline());
    first = earliest(first, next_keys(g));
    first = earliest(first, g.sync.deadline());
    if (g.incomplete)
      first = earliest(first, g.incomplete->until);
  }
  return first;
}

// ---- what is known

const group* group_management::find(group_id x) const {
  const auto found = groups_.find(x);
  return found == groups_.end() ? nullptr : &found->second;
}

group* group_management::find(group_id x) {
  const auto found = groups_.find(x);
  return found == groups_.end() ? nullptr : &found->second;
}

std::optional<group_description> group_management::description(group_id x) const {
  if (const auto* const g = find(x))
    return g->description;
  if (const auto* const found = discovery_.find(x))
    return found->members.front().description;
  return std::nullopt;
}

bool group_management::is_listening(instant now) const {
  return discovery_.is_asking() ||
         std::ranges::any_of(attempts_, [](const auto& x) { return !x.second.is_member; }) ||
         std::ranges::any_of(groups_, [&](const auto& x) {
           const auto& g = x.second;
           return !g.sync.is_fine() || (g.sync.is_lost(now) && g.members.present() > 1);
         });
}

std::optional<group_management::schedule> group_management::schedule_of(group_id x,
                                                                        instant now) const {
  if (const auto* const g = find(x)) {
    if (!g->sync.is_known())
      return std::nullopt;
    return schedule{g->sync.at(now), g->description.management};
  }
  const found_member* best_offer = nullptr; // by whom we are asking, or would ask first
  if (const auto running = attempts_.find(x); running != attempts_.end())
    best_offer = &running->second.members.front();
  else if (const auto* const found = discovery_.find(x))
    best_offer = &found->members.front();
  if (best_offer == nullptr)
    return std::nullopt;
  const auto since = std::chrono::floor<std::chrono::microseconds>(now - best_offer->received_at);
  return schedule{best_offer->time + since, best_offer->description.management};
}

std::size_t group_management::footprint() const {
  // Our own handshake: who, nonce, cookie, a secret, a share, flags, when it ends. Of others' that
  // have succeeded: who, nonce, key, share, when.
  constexpr std::size_t own_handshake = 2 + 2 + 4 + 8 + 2 * 32 + 4 + 6;
  constexpr std::size_t of_others = 2 + 2 + 4 + key::size + 32 + 4;
  std::size_t sum =
      own_handshake + admitted_max * of_others + group_description::name_max + 16 + 32 + key::size;
  for (const auto& [id, g] : groups_)
    sum += group_description::name_max + key::size + 12 + session_ring::footprint() +
           g.members.footprint() + weak_sync::footprint() + members_sent_max * 6 +
           group::rumours_max * 10 + group::refusers_max * 8 + stored_group::neighbours_max * 2;
  return sum;
}

} // namespace rubicon::smepp
