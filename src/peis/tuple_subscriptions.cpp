// Who wants what: subscriptions of ours at others and of others here (peis-wire.md 15.6, TUP-10).
#include <algorithm>

#include "peis/package.hpp"
#include "peis/tuple_space.hpp"

namespace rubicon::peis {

namespace {

constexpr int refreshes_per_lifetime = 3;
/// After this long without news, a repeated push has arrived (peis-wire.md 8.2: 11.6 s at most).
constexpr duration settled_after = 15s;

prototype prototype_of(peer_id owner, const key& pattern) {
  prototype x;
  x.owner = owner;
  x.name = pattern;
  return x;
}

} // namespace

std::pair<cause, tuple_events> tuple_space::subscribe(peer_id owner, const key& pattern,
                                                      subscription_id id, instant now) {
  if (subscriptions_.contains(id) || subscriptions_.size() >= config_.subscriptions_max) {
    ++counters_.refused;
    return {cause::refused, {}};
  }
  const subscription x{id, owner, pattern};
  subscriptions_.emplace(id, x);
  wanted_.insert(pattern, x);
  if (!next_refresh_)
    next_refresh_ = now + config_.lifetime / refreshes_per_lifetime;
  tuple_events out;
  for (const auto* held : store_.find_all(owner, pattern))
    out.push_back(tuple_changed{id, *held});
  if (!first_with(x))
    return {cause::none, std::move(out)};
  for (const auto& [host, known] : hosts_) {
    if (owner == any_peer || owner == host)
      out.push_back(subscribe_message_to(host, known, x, false));
  }
  return {cause::none, std::move(out)};
}

/// Equal subscriptions of ours send one message, which that with the lowest id stands for.
bool tuple_space::first_with(const subscription& x) const {
  bool first = true;
  wanted_.for_equal(x.pattern, [&](const subscription& other) {
    first = first && (other.owner != x.owner || other.id >= x.id);
  });
  return first;
}

transmit tuple_space::subscribe_message_to(peer_id host, const known_host& known,
                                           const subscription& x, bool refresh) const {
  subscribe_message message{prototype_of(x.owner, x.pattern), std::nullopt};
  if (known.marked) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(config_.lifetime).count();
    message.lifetime = lifetime_tag{refresh, static_cast<std::uint8_t>(seconds)};
  }
  return {host, port::subscribe, {encode(message), {}}, no_request};
}

tuple_events tuple_space::unsubscribe(subscription_id id) {
  tuple_events out;
  const auto at = subscriptions_.find(id);
  if (at == subscriptions_.end())
    return out;
  const auto gone = at->second;
  subscriptions_.erase(at);
  wanted_.erase_if(gone.pattern, [id](const subscription& x) { return x.id == id; });
  bool shared = false;
  wanted_.for_equal(gone.pattern,
                    [&](const subscription& x) { shared = shared || x.owner == gone.owner; });
  if (shared)
    return out;
  auto message = encode_unsubscribe(prototype_of(gone.owner, gone.pattern));
  if (gone.owner == any_peer)
    out.push_back(transmit_all{port::unsubscribe, std::move(message)});
  else if (hosts_.contains(gone.owner))
    out.push_back(transmit{gone.owner, port::unsubscribe, {std::move(message), {}}, no_request});
  std::vector<std::pair<key, peer_id>> unwanted;
  for (const auto* x : store_.find_all(gone.owner, gone.pattern)) {
    if (x->owner != self_ && !wanted(*x))
      unwanted.emplace_back(x->name, x->owner);
  }
  for (const auto& [name, owner] : unwanted)
    static_cast<void>(store_.remove(name, owner));
  return out;
}

tuple_events tuple_space::on_host_appeared(peer_id host, bool marked) {
  hosts_[host] = {marked};
  return renew(host);
}

tuple_events tuple_space::renew(peer_id host) const {
  tuple_events out;
  const auto known = hosts_.find(host);
  if (known == hosts_.end())
    return out;
  for (const auto& [id, x] : subscriptions_) {
    if ((x.owner == any_peer || x.owner == host) && first_with(x))
      out.push_back(subscribe_message_to(host, known->second, x, false));
  }
  return out;
}

tuple_events tuple_space::on_subscribe(peer_id source, byte_view octets, instant now) {
  auto message = decode_subscribe(octets);
  if (!message || source == self_ ||
      (message->wanted.owner != any_peer && message->wanted.owner != self_)) {
    ++counters_.malformed;
    return {};
  }
  auto& wanted = message->wanted;
  std::optional<instant> expiry;
  if (message->lifetime) {
    expiry = now + std::chrono::seconds(message->lifetime->seconds);
    if (!next_refresh_)
      next_refresh_ = *expiry;
  }
  bool known = false;
  subscribers_.for_equal(wanted.name, [&](subscriber& x) {
    if (x.host == source && x.wanted == wanted) {
      x.expiry = expiry;
      known = true;
    }
  });
  if (known && message->lifetime && message->lifetime->refresh)
    return {};
  if (!known && subscribers_.size() >= config_.subscribers_max) {
    ++counters_.overflow;
    return {};
  }
  tuple_events out;
  for (const auto* x : store_.find_all(self_, wanted.name)) {
    if (!wanted.matches(*x))
      continue;
    ++counters_.pushes_sent;
    out.push_back(
        transmit{source,
                 port::push,
                 {encode_tuple_head(*x, tuple_message_kind::push), encode_tuple_value(*x)},
                 no_request});
  }
  if (!known)
    subscribers_.insert(wanted.name, {source, wanted, expiry});
  return out;
}

tuple_events tuple_space::on_unsubscribe(peer_id source, byte_view octets) {
  const auto unwanted = decode_unsubscribe(octets);
  if (!unwanted) {
    ++counters_.malformed;
    return {};
  }
  // Only owner and key of the message mean anything (peis-wire.md 15.2).
  subscribers_.erase_if(unwanted->name, [&](const subscriber& x) {
    return x.host == source && x.wanted.owner == unwanted->owner;
  });
  return {};
}

/// To each subscriber once, however many of its subscriptions match.
void tuple_space::push(const tuple& x, tuple_events& out) {
  std::vector<peer_id> hosts;
  const bool deletion = x.expiry == deleted; // tell them too who asked for a certain value
  subscribers_.for_matching(x.name, [&](const subscriber& s) {
    if (deletion || s.wanted.matches(x))
      hosts.push_back(s.host);
  });
  if (hosts.empty())
    return;
  std::sort(hosts.begin(), hosts.end());
  hosts.erase(std::unique(hosts.begin(), hosts.end()), hosts.end());
  const message_octets content{encode_tuple_head(x, tuple_message_kind::push),
                               encode_tuple_value(x)};
  counters_.pushes_sent += hosts.size();
  for (const auto host : hosts)
    out.push_back(transmit{host, port::push, content, no_request});
}

bool tuple_space::has_subscribed(peer_id host, const tuple& x) const {
  bool found = false;
  subscribers_.for_matching(x.name, [&](const subscriber& s) {
    found = found || (s.host == host && s.wanted.matches(x));
  });
  return found;
}

bool tuple_space::has_subscriber(const key& name) const {
  bool found = false;
  subscribers_.for_matching(name, [&](const subscriber&) { found = true; });
  wanted_.for_matching(name, [&](const subscription& x) {
    found = found || x.owner == any_peer || x.owner == self_;
  });
  return found;
}

void tuple_space::schedule_retry(instant now) {
  if (!next_retry_)
    next_retry_ = now + config_.retry_push;
}

tuple_events tuple_space::on_undelivered(peer_id destination, std::uint16_t port, byte_view head,
                                         instant now) {
  if (!hosts_.contains(destination))
    return {};
  if (port == port::subscribe) {
    renewals_.insert(destination);
    schedule_retry(now);
  } else if (port == port::push) {
    if (const auto name = decode_record_key(head)) {
      failed_.try_emplace({destination, name->folded()}, failed_push{now, std::nullopt})
          .first->second.tried.reset();
      schedule_retry(now);
    }
  }
  return {};
}

/// The newest value only (TUP-18).
void tuple_space::retry_pushes(instant now, tuple_events& out) {
  next_retry_.reset();
  for (auto at = failed_.begin(); at != failed_.end();) {
    const auto& [host, text] = at->first;
    auto& x = at->second;
    const auto name = key::from_wire(text);
    const auto* content = name ? store_.find(*name, self_) : nullptr;
    const bool given_up = now - x.first > config_.give_up_push;
    const bool settled = x.tried && now - *x.tried > settled_after;
    if (content == nullptr || !has_subscribed(host, *content) || given_up || settled) {
      counters_.pushes_given_up += given_up ? 1 : 0;
      at = failed_.erase(at);
      continue;
    }
    if (!x.tried) {
      x.tried = now;
      ++counters_.pushes_retried;
      out.push_back(transmit{
          host,
          port::push,
          {encode_tuple_head(*content, tuple_message_kind::push), encode_tuple_value(*content)},
          no_request});
    }
    ++at;
  }
  for (const auto host : std::exchange(renewals_, {})) {
    auto messages = renew(host);
    std::move(messages.begin(), messages.end(), std::back_inserter(out));
  }
  if (!failed_.empty())
    schedule_retry(now);
}

/// Ours at marked hosts are repeated; those of marked hosts that were not repeated end.
void tuple_space::refresh(instant now, tuple_events& out) {
  next_refresh_.reset();
  bool mortal = false;
  subscribers_.erase_everywhere([&](const subscriber& x) {
    mortal = mortal || (x.expiry && *x.expiry > now);
    return x.expiry && *x.expiry <= now;
  });
  for (const auto& [id, x] : subscriptions_) {
    for (const auto& [host, known] : hosts_) {
      if (known.marked && (x.owner == any_peer || x.owner == host) && first_with(x))
        out.push_back(subscribe_message_to(host, known, x, true));
    }
  }
  if (mortal || !subscriptions_.empty())
    next_refresh_ = now + config_.lifetime / refreshes_per_lifetime;
}

} // namespace rubicon::peis
