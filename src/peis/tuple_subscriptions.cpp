// Who wants what: subscriptions of ours at others and of others here (peis-wire.md 15.6, TUP-10).
#include <algorithm>
#include <iterator>
#include <tuple>

#include "peis/package.hpp"
#include "peis/tuple_space.hpp"

namespace rubicon::peis {

namespace {

constexpr int refreshes_per_lifetime = 3;
constexpr std::size_t dormant_hosts_max = 64;
constexpr std::size_t dormant_subscriptions_max = 256; // of one host
/// After this long without news, a repeated push has arrived (peis-wire.md 8.2: 11.6 s at most).
constexpr duration settled_after = 15s;

transmit push_message(const tuple& x, peer_id subscriber) {
  return {subscriber,
          port::push,
          {encode_tuple_head(x, tuple_message_kind::push), encode_tuple_value(x)},
          no_request};
}

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
  if (!first_with(x))
    return {cause::none, std::move(out)};
  for (const auto& [host, known] : hosts_) {
    if (wanted.owner == any_peer || wanted.owner == host)
      out.push_back(subscribe_message_to(host, known, wanted, false));
  }
  return {cause::none, std::move(out)};
}

/// Equal subscriptions of ours send one message, which that with the lowest id stands for. None is
/// sent for callbacks.
bool tuple_space::first_with(const subscription& x) const {
  bool first = x.kind == interest::subscription;
  wanted_.for_equal(x.wanted.name, [&](const subscription& other) {
    first = first &&
            (other.kind == interest::callback || other.id >= x.id || !(other.wanted == x.wanted));
  });
  return first;
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

tuple_events tuple_space::on_host_appeared(peer_id host, bool marked, std::int32_t incarnation,
                                           instant now) {
  hosts_[host] = {marked, incarnation};
  auto out = renew(host, false);
  const auto rested = dormant_.extract(host);
  if (rested.empty() || rested.mapped().incarnation != incarnation)
    return out;
  for (const auto& wanted : rested.mapped().wanted) {
    auto pushes = on_subscribe(host, encode(subscribe_message{wanted, std::nullopt}), now);
    std::move(pushes.begin(), pushes.end(), std::back_inserter(out));
  }
  return out;
}

void tuple_space::lay_down(peer_id host) {
  const auto known = hosts_.find(host);
  if (known == hosts_.end() || known->second.marked || known->second.incarnation == 0)
    return;
  dormant_host x{known->second.incarnation, {}};
  subscribers_.for_all([&](const subscriber& s) {
    if (s.host == host && !s.expiry && x.wanted.size() < dormant_subscriptions_max)
      x.wanted.push_back(s.wanted);
  });
  if (x.wanted.empty())
    return;
  if (dormant_.size() >= dormant_hosts_max) {
    dormant_.erase(dormant_.begin());
    ++counters_.overflow;
  }
  dormant_[host] = std::move(x);
}

tuple_events tuple_space::renew(peer_id host, bool refresh) const {
  tuple_events out;
  const auto known = hosts_.find(host);
  if (known == hosts_.end())
    return out;
  for (const auto& [id, x] : subscriptions_) {
    if ((x.wanted.owner == any_peer || x.wanted.owner == host) && first_with(x))
      out.push_back(subscribe_message_to(host, known->second, x.wanted, refresh));
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
  const auto owner = wanted.owner;
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
  wanted.owner = self_; // for the search only
  for (const auto& x : store_.find_all(wanted)) {
    ++counters_.pushes_sent;
    if (channels_.busy(x->name, source))
      collapse(x->name, now); // what is under way would be applied to a value that has it already
    auto push_now = push_message(*store_.find(self_, x->name)->content, source);
    if (channels_.follows(x->name))
      transmit_in_order(x->name, std::move(push_now), out);
    else
      out.push_back(std::move(push_now));
  }
  if (!known) {
    wanted.owner = owner;
    subscribers_.insert(wanted.name, {source, wanted, expiry});
    ++subscribers_version_;
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
  const auto erased = subscribers_.erase_if(unwanted->name, [&](const subscriber& x) {
    return x.host == source && x.wanted.owner == unwanted->owner;
  });
  subscribers_version_ += erased > 0 ? 1 : 0;
  return {};
}

/// Each once, however many of its subscriptions match. A deletion concerns those too who asked for
/// a certain value.
std::vector<peer_id> tuple_space::subscribers_of(const tuple& x) const {
  std::vector<peer_id> hosts;
  subscribers_.for_matching(x.name, [&](const subscriber& s) {
    if (x.expiry == deleted || s.wanted.matches(x))
      hosts.push_back(s.host);
  });
  std::sort(hosts.begin(), hosts.end());
  hosts.erase(std::unique(hosts.begin(), hosts.end()), hosts.end());
  return hosts;
}

void tuple_space::push(const tuple& x, tuple_events& out) {
  const auto hosts = subscribers_of(x);
  if (hosts.empty())
    return;
  auto message = push_message(x, hosts.front());
  counters_.pushes_sent += hosts.size();
  for (const auto host : hosts) {
    message.destination = host;
    out.push_back(message);
  }
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
  const auto note = [&](const key& wanted) {
    const auto& text = wanted.folded();
    if (text.substr(0, text.find('.')) == first_part)
      all.insert(text);
  };
  subscribers_.for_all([&](const subscriber& x) { note(x.wanted.name); });
  wanted_.for_all([&](const subscription& x) {
    if (x.kind == interest::subscription && (x.wanted.owner == any_peer || x.wanted.owner == self_))
      note(x.wanted.name);
  });
  return all;
}

void tuple_space::schedule_retry(instant now) {
  if (!next_retry_)
    next_retry_ = now + config_.retry_push;
}

void tuple_space::add_failed_push(peer_id host, const key& name, instant now) {
  failed_.try_emplace({host, name.folded()}, failed_push{now, std::nullopt})
      .first->second.tried.reset();
  schedule_retry(now);
}

void tuple_space::on_undelivered(peer_id destination, std::uint16_t port, byte_view head,
                                 request_id request, instant now) {
  const bool concerns_tuple = port == port::push || port == port::append_notice;
  const auto name = concerns_tuple ? decode_record_key(head) : result<key>(errc::unsupported);
  if (name && channels_.knows(request))
    collapse(*name, now);
  if (name) {
    add_failed_push(destination, *name, now); // also to a host whose way is not known yet
  } else if (port == port::subscribe && hosts_.contains(destination)) {
    renewals_.insert(destination);
    schedule_retry(now);
  }
}

/// The newest value only (TUP-18).
void tuple_space::retry_pushes(instant now, tuple_events& out) {
  next_retry_.reset();
  for (auto at = failed_.begin(); at != failed_.end();) {
    const auto& [host, text] = at->first;
    auto& x = at->second;
    const auto name = key::from_wire(text);
    const auto content = name ? find(self_, *name) : nullptr;
    const bool overtaken = name && channels_.busy(*name, host); // by a whole value, with appends
    const bool given_up = now - x.first > config_.give_up_push;
    const bool settled = x.tried && now - *x.tried > settled_after;
    if (!content || !has_subscribed(host, *content) || overtaken || given_up || settled) {
      counters_.pushes_given_up += given_up ? 1 : 0;
      at = failed_.erase(at);
      continue;
    }
    if (!x.tried) {
      x.tried = now;
      ++counters_.pushes_retried;
      out.push_back(push_message(*content, host));
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
  const auto erased = subscribers_.erase_everywhere([&](const subscriber& x) {
    mortal = mortal || (x.expiry && *x.expiry > now);
    return x.expiry && *x.expiry <= now;
  });
  subscribers_version_ += erased > 0 ? 1 : 0;
  for (const auto& [id, x] : subscriptions_) {
    for (const auto& [host, known] : hosts_) {
      if (known.marked && (x.wanted.owner == any_peer || x.wanted.owner == host) && first_with(x))
        out.push_back(subscribe_message_to(host, known, x.wanted, true));
    }
  }
  if (mortal || !subscriptions_.empty())
    next_refresh_ = now + config_.lifetime / refreshes_per_lifetime;
}

} // namespace rubicon::peis
