// Who wants what: subscriptions of ours at others and of others here (peis-wire.md 15.6, TUP-10).
#include <algorithm>
#include <iterator>
#include <tuple>

#include "peis/package.hpp"
#include "peis/tuple_space.hpp"

namespace rubicon::peis {

namespace {

constexpr int refreshes_per_lifetime = 3;
constexpr std::size_t few_subscriptions = 64; ///< of one host: walked

} // namespace

std::pair<cause, tuple_events> tuple_space::subscribe(const prototype& wanted, subscription_id id,
                                                      interest kind, instant now) {
  auto why = cause::none;
  if (subscriptions_.contains(id))
    why = cause::bad_handle;
  else if (subscriptions_.size() >= config_.subscriptions_max)
    why = cause::space_full;
  else if (wanted.mimetype && wanted.mimetype->size() > mimetype_length_max)
    why = cause::bad_value;
  else if (wanted.value && wanted.value->size() > tuple_value_max)
    why = cause::too_long;
  if (why != cause::none) {
    ++counters_.refused;
    return {why, {}};
  }
  const subscription x{id, wanted, kind};
  subscriptions_.emplace(id, x);
  wanted_.insert(wanted.name, x);
  ++subscribers_version_;
  if (kind == interest::callback)
    return {};
  if (!next_refresh_)
    next_refresh_ = now + config_.lifetime / refreshes_per_lifetime;
  tuple_events out;
  for (auto& held : store_.find_all(wanted))
    out.push_back(tuple_changed{id, std::move(held)});
  const auto* asked = add_question(wanted);
  if (asked == nullptr)
    return {cause::none, std::move(out)};
  for (const auto& [host, known] : hosts_) {
    if (wanted.owner != any_peer && wanted.owner != host)
      continue;
    const auto owed = debts_.find(host);
    if (owed != debts_.end() && owed->second.ask)
      continue; // it is the last in the row that is going out
    debts_[host].ask = debt::asking{asked->serial, false};
    serve_now(host, now, out);
  }
  return {cause::none, std::move(out)};
}

/// Equal subscriptions of ours send one message. None is sent for callbacks.
/// @returns a question that nobody has been asked yet; null if it is not the first of its kind
const tuple_space::question* tuple_space::add_question(const prototype& wanted) {
  const auto [at, first] = questions_.try_emplace(identity_of(wanted));
  auto& x = at->second;
  ++x.askers;
  if (!first)
    return nullptr;
  x.wanted = wanted;
  x.serial = next_serial_++;
  questions_by_serial_.emplace_hint(questions_by_serial_.end(), x.serial, &x);
  return &x;
}

void tuple_space::remove_question(const prototype& wanted) {
  const auto at = questions_.find(identity_of(wanted));
  if (--at->second.askers > 0)
    return;
  questions_by_serial_.erase(at->second.serial);
  questions_.erase(at);
}

transmit tuple_space::subscribe_message_to(peer_id host, const known_host& known,
                                           const prototype& wanted, bool refresh) const {
  subscribe_message message{wanted, std::nullopt};
  if (known.marked) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(config_.lifetime).count();
    message.lifetime = lifetime_tag{refresh, static_cast<std::uint8_t>(seconds)};
  }
  return {host, port::subscribe, {encode(message), {}}, no_request};
}

std::pair<cause, tuple_events> tuple_space::unsubscribe(subscription_id id) {
  tuple_events out;
  const auto at = subscriptions_.find(id);
  if (at == subscriptions_.end())
    return {cause::bad_handle, {}};
  const auto gone = at->second;
  subscriptions_.erase(at);
  wanted_.erase_if(gone.wanted.name, [id](const subscription& x) { return x.id == id; });
  ++subscribers_version_;
  if (gone.kind == interest::callback)
    return {};
  remove_question(gone.wanted);
  // The message names owner and key only: it would end the others of that name too.
  bool shared = false;
  wanted_.for_equal(gone.wanted.name, [&](const subscription& x) {
    shared = shared || (x.kind == interest::subscription && x.wanted.owner == gone.wanted.owner);
  });
  if (!shared) {
    auto message = encode_unsubscribe(gone.wanted);
    const auto owner = gone.wanted.owner;
    if (owner == any_peer)
      out.push_back(transmit_all{port::unsubscribe, std::move(message)});
    else if (hosts_.contains(owner))
      out.push_back(transmit{owner, port::unsubscribe, {std::move(message), {}}, no_request});
  }
  for (const auto& x : store_.find_all(prototype_of(gone.wanted.owner, gone.wanted.name))) {
    if (x->owner != self_ && !wanted(*x)) {
      incomplete_.erase({x->owner, x->name.folded()});
      static_cast<void>(store_.remove(x->owner, x->name));
    }
  }
  return {cause::none, std::move(out)};
}

tuple_events tuple_space::on_host_appeared(peer_id host, bool marked, instant now,
                                           std::int32_t incarnation) {
  strangers_.erase(host);
  hosts_[host] = {marked, incarnation};
  if (const auto owed = debts_.find(host); owed != debts_.end()) {
    owed->second.not_before.reset(); // there is a way now
    settle(owed, now);
  }
  auto out = renew(host, now, false);
  wake_up(host, incarnation, now, out);
  return out;
}

tuple_events tuple_space::renew(peer_id host, instant now, bool refresh) {
  tuple_events out;
  if (!hosts_.contains(host) || questions_.empty())
    return out;
  ask_all(host, refresh);
  serve_now(host, now, out);
  return out;
}

tuple_events tuple_space::on_subscribe(peer_id source, byte_view octets, instant now) {
  auto message = decode_subscribe(octets, network_time(now));
  if (!message || source == self_ ||
      (message->wanted.owner != any_peer && message->wanted.owner != self_)) {
    ++counters_.malformed;
    return {};
  }
  std::optional<instant> expiry;
  if (message->lifetime) {
    expiry = now + std::chrono::seconds(message->lifetime->seconds);
    if (!next_refresh_)
      next_refresh_ = *expiry;
  }
  if (!acquainted(source, now))
    return {};
  auto* known = subscribers_.find(source, message->wanted);
  if (known != nullptr) {
    known->expiry = expiry;
    if (message->lifetime && message->lifetime->refresh)
      return {};
  } else {
    known = subscribers_.add(source, message->wanted, expiry);
    ++(known != nullptr ? subscribers_version_ : counters_.subscribers_refused);
  }
  tuple_events out;
  if (known != nullptr) {
    owe_walk(*known);
    serve_now(source, now, out);
  }
  return out;
}

tuple_events tuple_space::on_unsubscribe(peer_id source, byte_view octets) {
  const auto unwanted = decode_unsubscribe(octets);
  if (!unwanted) {
    ++counters_.malformed;
    return {};
  }
  // Only owner and key of the message mean anything (peis-wire.md 15.2).
  const auto erased = subscribers_.erase(source, unwanted->owner, unwanted->name);
  for (const auto number : erased)
    forget_walk(source, number);
  subscribers_version_ += erased.empty() ? 0 : 1;
  return {};
}

/// Looks at what the host wants or at what is wanted of the tuple: others make either long.
bool tuple_space::has_subscribed(peer_id host, const tuple& x) const {
  const auto* all = subscribers_.of(host);
  if (all == nullptr)
    return false;
  if (all->size() <= few_subscriptions) {
    return std::ranges::any_of(*all, [&](const auto& record) {
      const auto& wanted = record.second->wanted;
      return x.expiry == deleted ? wanted.name.matches(x.name) : wanted.matches(x);
    });
  }
  bool found = false;
  subscribers_.for_matching(x.name, [&](const subscriber& s) {
    found = found || (s.host == host && (x.expiry == deleted || s.wanted.matches(x)));
  });
  return found;
}

bool tuple_space::has_subscriber(const key& name) const {
  bool found = false;
  subscribers_.for_matching(name, [&](const subscriber&) { found = true; });
  wanted_.for_matching(name, [&](const subscription& x) {
    found = found || (x.kind == interest::subscription &&
                      (x.wanted.owner == any_peer || x.wanted.owner == self_));
  });
  return found;
}

bool tuple_space::is_watched(const key& name) const {
  bool found = has_subscriber(name);
  wanted_.for_matching(name, [&](const subscription& x) {
    found = found || x.wanted.owner == any_peer || x.wanted.owner == self_;
  });
  return found;
}

std::vector<std::pair<peer_id, prototype>> tuple_space::subscribers() const {
  std::vector<std::pair<peer_id, prototype>> all;
  subscribers_.for_all([&](const subscriber& x) { all.emplace_back(x.host, x.wanted); });
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second.owner, a.second.name.folded()) <
           std::tie(b.first, b.second.owner, b.second.name.folded());
  });
  return all;
}

std::set<std::string> tuple_space::subscribed(std::string_view first_part) const {
  std::set<std::string> all;
  const auto note = [&](const key& wanted) { all.insert(wanted.folded()); };
  subscribers_.for_first_part(first_part, [&](const subscriber& x) { note(x.wanted.name); });
  wanted_.for_first_part(first_part, [&](const subscription& x) {
    if (x.kind == interest::subscription && (x.wanted.owner == any_peer || x.wanted.owner == self_))
      note(x.wanted.name);
  });
  return all;
}

/// Ours at marked hosts are repeated; those of marked hosts that were not repeated end.
void tuple_space::refresh(instant now, tuple_events& out) {
  next_refresh_.reset();
  const auto found = subscribers_.find_expired(now);
  for (const auto* x : found.gone) {
    forget_walk(x->host, x->number);
    subscribers_.erase(*x);
  }
  subscribers_version_ += found.gone.empty() ? 0 : 1;
  for (const auto& [host, known] : hosts_) {
    if (known.marked && !questions_.empty()) {
      ask_all(host, true);
      serve_now(host, now, out);
    }
  }
  if (found.mortal || !subscriptions_.empty())
    next_refresh_ = now + config_.lifetime / refreshes_per_lifetime;
}

} // namespace rubicon::peis
