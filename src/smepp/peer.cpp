// The commands of a peer, and how its parts work together.
#include <algorithm>
#include <cassert>

#include "core/overloads.hpp"
#include "smepp/smepp.hpp"

namespace rubicon::smepp {

namespace {

/// @param end of the counters
peer_config with_self(peer_config x, std::uint64_t end) {
  x.security.counter_end = end;
  x.security.self = x.self;
  x.groups.self = x.self;
  x.groups.transducers = x.transducers;
  x.events.self = x.self;
  return x;
}

persistent_state with_identity(persistent_state x, randomness& secrets) {
  if (!x.identity)
    x.identity = agreement::make(secrets).reveal();
  return x;
}

} // namespace

peer::~peer() = default;
peer::peer(peer&&) noexcept = default;
peer& peer::operator=(peer&&) noexcept = default;

peer::peer(peer_config config, random_stream rng, instant now, persistent_state before)
    : config_(with_self(config, before.counter_end)), rng_(rng),
      secrets_(config_.has_system_randomness ? randomness()
                                             : randomness(random_stream(rng_.next()))),
      persistent_(with_identity(std::move(before), secrets_)),
      security_(config_.security, persistent_.counter_reserved),
      groups_(config_.groups, random_stream(rng_.next()), secrets_,
              agreement(*persistent_.identity)),
      events_(config_.events, random_stream(rng_.next())), energy_(config_.energy),
      outbox_(config_.outbox_max, config_.send_spread, random_stream(rng_.next())),
      awake_until_(now), cycles_from_(now), last_(now) {
  for (const auto& [other, shared] : config_.pairwise)
    static_cast<void>(events_.set_pairwise_key(other, shared));
}

// ---- commands

mote_id peer::smepp_newPeer(const key& network_key, const key& network_mac, instant now,
                            outputs& out) {
  security_.set_network_keys({network_key, network_mac}, now);
  const auto before = persistent_.groups;
  for (const auto& x : before)
    groups_.restore(x, with(now));
  go_on(now, out);
  return config_.self;
}

std::variant<group_id, failure> peer::smepp_createGroup(const group_description& x, instant now,
                                                        outputs& out) {
  const auto result = groups_.create(x, with(now));
  go_on(now, out);
  return result;
}

void peer::smepp_getGroups(const group_filter& x, instant now, outputs& out) {
  groups_.ask(x, with(now));
  on_time(now, out);
}

std::optional<group_description> peer::smepp_getGroupDescription(group_id group) const {
  return groups_.description(group);
}

void peer::smepp_joinGroup(group_id group, const std::optional<key>& master_key, instant now,
                           outputs& out) {
  const auto description = groups_.description(group);
  const auto& masters = config_.masters;
  const auto provisioned = description ? masters.find(description->name) : masters.end();
  if (provisioned != masters.end() && master_key && !(provisioned->second == *master_key))
    actions_.emplace_back(signal{joinGroup_result{group, {}, failure::wrong_master_key}});
  else if (provisioned != masters.end())
    groups_.join(group, provisioned->second, with(now));
  else
    groups_.join(group, master_key, with(now));
  go_on(now, out);
}

std::vector<peer_description> peer::smepp_getPeers(group_id group) const {
  const auto* const g = groups_.find(group);
  return g == nullptr ? std::vector<peer_description>{} : g->members.descriptions();
}

std::optional<failure> peer::smepp_leaveGroup(group_id group, instant now, outputs& out) {
  if (groups_.find(group) != nullptr)
    static_cast<void>(events_.unsubscribe(group, "", with(now)));
  const auto error = groups_.leave(group, with(now));
  go_on(now, out);
  return error;
}

std::optional<failure> peer::smepp_subscribe(const std::string& event_name, group_id group,
                                             std::optional<duration> expiration_time, double rate,
                                             instant now, outputs& out) {
  const auto* const g = groups_.find(group);
  if (g == nullptr || g->leaving_at || !g->sync.is_known())
    return failure::not_a_member;
  const auto error = events_.subscribe(*g, event_name, expiration_time, rate, with(now));
  set_cycles(now);
  go_on(now, out);
  return error;
}

std::optional<failure> peer::smepp_unsubscribe(const std::string& event_name, group_id group,
                                               instant now, outputs& out) {
  if (groups_.find(group) == nullptr)
    return failure::not_a_member;
  const auto error = events_.unsubscribe(group, event_name, with(now));
  set_cycles(now);
  go_on(now, out);
  return error;
}

std::optional<failure> peer::smepp_event(group_id group, const std::string& event_name,
                                         const bytes& value, instant now, outputs& out) {
  const auto* const g = groups_.find(group);
  if (g == nullptr || g->leaving_at || !g->sync.is_known())
    return failure::not_a_member;
  const auto error = events_.event(*g, event_name, value, with(now));
  go_on(now, out);
  return error;
}

std::optional<failure> peer::smepp_receive(group_id group, const std::string& event_name,
                                           double frequency, instant now, outputs& out) {
  if (groups_.find(group) == nullptr)
    return failure::not_a_member;
  const auto error = events_.receive(group, event_name, frequency);
  set_cycles(now);
  go_on(now, out);
  return error;
}

void peer::set_network_keys(const key& network_key, const key& network_mac, instant now,
                            outputs& out) {
  security_.set_network_keys({network_key, network_mac}, now);
  go_on(now, out);
}

std::optional<failure> peer::refresh_session_keys(group_id group, instant now, outputs& out) {
  const auto error = groups_.refresh_keys(group, with(now));
  go_on(now, out);
  return error;
}

// ---- time

void peer::on_time(instant now, outputs& out) {
  security_.on_time(now);
  groups_.on_time(with(now));
  events_.on_time(groups_, with(now));
  if (flight_ && flight_->until <= now) {
    drop("radio_silent");
    on_sent(flight_->id, false, now, now, out);
  }
  go_on(now, out);
}

std::optional<instant> peer::deadline() const {
  auto first = earliest(security_.deadline(), groups_.deadline());
  first = earliest(first, events_.deadline(groups_));
  first = earliest(first, flight_ ? std::optional(flight_->until) : outbox_.deadline());
  if (config_.saves_energy) {
    first = earliest(first, energy_.next_change(last_));
    if (is_radio_on_ && awake_until_ > last_)
      first = earliest(first, awake_until_);
  }
  return first;
}

/// After each input: does what the parts have asked for, sends what may be sent.
void peer::go_on(instant now, outputs& out) {
  last_ = now;
  perform(now, out);
  complete_joins(now);
  perform(now, out);
  pump(now, out);
  set_radio_state(now, out);
}

void peer::perform(instant now, outputs& out) {
  while (!actions_.empty()) {
    const auto todo = std::exchange(actions_, {});
    for (const auto& x : todo)
      std::visit([&](const auto& each) { perform(each, now, out); }, x);
  }
}

void peer::perform(const to_send& x, instant now, outputs& /*out*/) {
  // Who has joined just now has but the next keys: broadcasts are sent under these, too.
  const auto* const g = groups_.find(x.group);
  if (x.to == broadcast_mote && g != nullptr && !is_network_level(x.content) && !x.under &&
      g->ring.best().id != g->ring.sending(now)) {
    auto again = x;
    again.under = g->ring.best().id;
    again.copies = 1;
    if (!outbox_.push(again, now))
      drop("outbox_full");
  }
  if (outbox_.push(x, now))
    return;
  drop("outbox_full");
  end_hop(x.token, false, now);
}

/// Passes the outcome to the part that has given the token.
void peer::end_hop(std::uint64_t token, bool acked, instant now) {
  constexpr duration reply_wait = 300ms;
  if ((token & step_token) == 0) {
    if (token != 0)
      events_.on_sent(token, acked, with(now));
    return;
  }
  if (groups_.on_step_sent(group_id{static_cast<std::uint16_t>(token)}, acked, with(now)))
    awake_until_ = std::max(awake_until_, now + reply_wait);
}

void peer::perform(const keys_changed& /*x*/, instant now, outputs& out) {
  set_cycles(now); // of a group that has come or gone
  auto fresh = to_store();
  if (fresh.groups == persistent_.groups)
    return;
  persistent_ = std::move(fresh);
  out.emplace_back(store_state{persistent_});
}

void peer::perform(const group_gone& x, instant now, outputs& /*out*/) {
  static_cast<void>(outbox_.forget(x.group));
  events_.on_group_gone(x.group, with(now));
}

void peer::perform(const newcomer& x, instant now, outputs& /*out*/) {
  events_.introduce(x, with(now));
}

void peer::perform(const signal& x, instant now, outputs& out) {
  if (const auto* const gone = std::get_if<peerLeft>(&x); gone && gone->peer != config_.self)
    events_.on_left(gone->peer, gone->group, with(now));
  if (std::holds_alternative<subscribed>(x) || std::holds_alternative<unsubscribed>(x))
    set_cycles(now);
  out.emplace_back(x);
}

/// Signals joinGroup_result for each group whose members and subscriptions are complete.
void peer::complete_joins(instant now) {
  for (const auto& [id, g] : groups_.all()) {
    if (!groups_.complete_join(id, events_.count(id), now))
      continue;
    joinGroup_result result{id, {}, std::nullopt};
    for (const auto& x : events_.all())
      if (x.group == id)
        result.subscriptions.push_back(event_management::info(x, g));
    actions_.emplace_back(signal{result});
  }
}

persistent_state peer::to_store() const {
  auto x = persistent_;
  x.groups.clear();
  for (const auto& [id, g] : groups_.all()) {
    const auto* const own = g.members.find(config_.self);
    x.groups.push_back({id, g.description, g.ring.best(),
                        own != nullptr ? own->stamp : std::uint16_t{0}, g.neighbours});
  }
  return x;
}

std::size_t peer::footprint() const {
  return security_.footprint() + groups_.footprint() + events_.footprint() + outbox_.footprint();
}

} // namespace rubicon::smepp
