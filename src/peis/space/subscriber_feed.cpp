// Who is sent which change, and what becomes pending.
#include "peis/space/subscriber_feed.hpp"

#include <algorithm>
#include <utility>

#include "peis/wire/package.hpp"

namespace rubicon::peis {

namespace {

constexpr int refreshes_per_lifetime = 3;
constexpr std::size_t undelivered_unreached_max = 4; ///< of an unknown host

} // namespace

subscriber_feed::subscriber_feed(const tuple_space_config& config, peer_id self, own_tuples& own,
                                 tuple_hosts& hosts, const local_subscriptions& local,
                                 std::shared_ptr<fair_share> pool)
    : config_(config), self_(self), own_(own), hosts_(hosts), local_(local),
      subscribers_({config.subscribers_max, config.subscribers_octets_max, std::move(pool),
                    config.subscribers_per_key_max}),
      window_(config.pushes),
      channels_(config.appends_waiting_max, config.appends_waiting_octets_max) {}

bool subscriber_feed::takes_notices(const tuple& held) const {
  bool all_want_it = true;
  subscribers_.for_matching(held.name, [&](const subscriber& s) {
    all_want_it = all_want_it && !s.wanted.value && s.wanted.matches(held);
  });
  return all_want_it && channels_.follows(held.name) && !held.value.empty();
}

void subscriber_feed::publish(const own_change& x, instant now, tuple_events& out) {
  std::visit([&](const auto& change) { publish_one(change, now, out); }, x);
}

void subscriber_feed::publish_one(const own_value_set& x, instant now, tuple_events& out) {
  static_cast<void>(channels_.abandon(x.content->name)); // the whole value goes to all subscribers
  push(*x.content, now, out);
}

void subscriber_feed::publish_one(const own_value_deleted& x, instant now, tuple_events& out) {
  static_cast<void>(channels_.abandon(x.last.name));
  push(x.last, now, out);
}

void subscriber_feed::publish_one(const own_value_extended& x, instant, tuple_events& out) {
  const auto& content = *x.content;
  static_cast<void>(channels_.abandon(content.name));
  const auto hosts = subscribers_.hosts_for(content);
  if (!hosts.empty())
    channels_.follow(content.name);
  const message_octets message{encode_tuple_head(content, tuple_message_kind::push),
                               encode_tuple_value(content)};
  counters_.pushes_sent += hosts.size();
  for (const auto host : hosts)
    transmit_in_order(content.name, {host, port::push, message, no_request}, out);
}

void subscriber_feed::publish_one(const own_value_appended& x, instant now, tuple_events& out) {
  const auto& name = x.content->name;
  const message_octets message{encode_append_notice_head(*x.before, x.added.size()), x.added};
  std::vector<peer_id> overrun;
  for (const auto host : subscribers_.hosts_for(*x.content)) {
    if (channels_.full(name, host, message.size())) {
      overrun.push_back(host);
      continue;
    }
    ++counters_.append_notices_sent;
    transmit_in_order(name, {host, port::append_notice, message, no_request}, out);
  }
  if (overrun.empty())
    return;
  collapse(name, now);
  for (const auto host : overrun)
    retry_later(host, name, now, now);
}

void subscriber_feed::on_expired(const key& name) {
  static_cast<void>(channels_.abandon(name));
}

void subscriber_feed::push(const tuple& x, instant now, tuple_events& out) {
  const auto hosts = subscribers_.hosts_for(x);
  if (hosts.empty())
    return;
  work_.add(hosts.size() / 2);
  const auto message = push_message(x, hosts.front());
  for (const auto host : hosts) {
    if (auto* unreached = find_unreached(host, now)) {
      miss_unreached(host, *unreached, x);
      continue;
    }
    if (!window_.admits(host, message.content.size())) {
      ++counters_.pushes_deferred;
      miss(host, x.name, std::nullopt);
      plan(host, now);
      continue;
    }
    ++counters_.pushes_sent;
    counters_.pushes_overtaken += feeds_.remove_undelivered(host, x.name.folded()) ? 1 : 0;
    auto to_host = message;
    to_host.destination = host;
    out.push_back(in_flight(std::move(to_host), {}, {}));
  }
}

/// The pending feed of an unknown host that has just not been reached. It is tried
/// again in its time, however many values change meanwhile. Null for any other.
pending_feed* subscriber_feed::find_unreached(peer_id host, instant now) {
  if (hosts_.knows(host))
    return nullptr;
  auto* feed = feeds_.find(host);
  return feed != nullptr && feed->not_before && *feed->not_before > now ? feed : nullptr;
}

/// A few values are remembered one by one. Then all is scanned when there is a route, from its
/// beginning, and a change costs nothing until then.
void subscriber_feed::miss_unreached(peer_id host, pending_feed& feed, const tuple& changed) {
  const bool all_is_pending = !feed.queue_scans.empty() && feed.scanned_after.empty();
  if (all_is_pending) {
    ++counters_.pushes_overtaken;
    counters_.pushes_given_up += changed.expiry == deleted ? 1 : 0; // no scan finds it
  } else if (feed.undelivered.size() < undelivered_unreached_max) {
    miss(host, changed.name, std::nullopt);
  } else {
    resynchronise(host);
    feed.scanned_after.clear();
  }
}

/// The newest value of a tuple, or its deletion, is to be sent to a host later. Who misses too many
/// is not sent each of them: all that he wants is scanned again.
void subscriber_feed::miss(peer_id host, const key& name, std::optional<instant> failing_since) {
  counters_.pushes_overtaken += feeds_.add_undelivered(host, name.folded(), failing_since) ? 0 : 1;
  if (feeds_.has_too_many(host, config_.missed_max))
    resynchronise(host);
}

/// Tries again when a route to that host may have been found.
void subscriber_feed::retry_later(peer_id host, const key& name, instant failing_since,
                                  instant now) {
  miss(host, name, failing_since);
  auto& feed = feeds_.open(host);
  feed.not_before = now + config_.retry_push;
  feeds_.schedule(host, feed.not_before);
}

/// All that it wants is to be scanned.
void subscriber_feed::resynchronise(peer_id host) {
  ++counters_.resyncs;
  for (const auto& [folded, since] : feeds_.open(host).undelivered) {
    const auto name = key::from_wire(folded); // deletions: no scan finds them
    counters_.pushes_given_up += name && own_.find(*name) == nullptr ? 1 : 0;
  }
  feeds_.clear_undelivered(host);
  if (const auto* all = subscribers_.of(host)) {
    for (const auto& [number, s] : *all)
      begin_queue_scan(*s);
  }
}

/// All that matches is to be sent; a scan that has begun goes to its end first, then begins again.
void subscriber_feed::begin_queue_scan(subscriber& x) {
  if (!feeds_.open(x.host).queue_scans.emplace(x.number, &x).second)
    x.again = true;
}

void subscriber_feed::end_queue_scan(peer_id host, std::uint64_t number) {
  auto* feed = feeds_.find(host);
  if (feed == nullptr || !feed->queue_scans.contains(number))
    return;
  if (feed->queue_scans.begin()->first == number)
    feed->scanned_after.clear();
  feed->queue_scans.erase(number);
}

void subscriber_feed::transmit_in_order(const key& name, transmit message, tuple_events& out) {
  if (auto first = channels_.send(name, std::move(message)))
    out.push_back(std::move(*first));
}

/// Gives up what has not left yet. Those who miss it get the whole value soon, under a number of
/// its own: a holder of the current one would refuse it.
void subscriber_feed::collapse(const key& name, instant now) {
  const auto missing = channels_.abandon(name);
  ++counters_.appends_collapsed;
  own_.renumber(name);
  for (const auto host : missing)
    retry_later(host, name, now, now);
}

void subscriber_feed::subscribe(peer_id source, const prototype& wanted,
                                std::optional<lifetime_tag> lifetime, instant now,
                                tuple_events& out) {
  std::optional<instant> expiry;
  if (lifetime) {
    expiry = now + std::chrono::seconds(lifetime->seconds);
    if (!next_refresh_)
      next_refresh_ = expiry;
  }
  if (!hosts_.admit(source, now))
    return;
  auto* known = subscribers_.find(source, wanted);
  if (known != nullptr) {
    known->expiry = expiry;
    if (lifetime && lifetime->refresh)
      return;
  } else {
    known = subscribers_.add(source, wanted, expiry);
    counters_.subscribers_refused += known == nullptr ? 1 : 0;
  }
  if (known != nullptr) {
    begin_queue_scan(*known);
    serve_now(source, now, out);
  }
}

void subscriber_feed::unsubscribe(peer_id source, peer_id owner, const key& wanted) {
  for (const auto number : subscribers_.erase(source, owner, wanted))
    end_queue_scan(source, number);
}

void subscriber_feed::ask(const local_subscriptions::question* unasked, instant now,
                          tuple_events& out) {
  if (!next_refresh_)
    next_refresh_ = now + config_.lifetime / refreshes_per_lifetime;
  if (unasked == nullptr)
    return;
  const auto owner = unasked->wanted.owner;
  for (const auto& [host, known] : hosts_.known()) {
    if (owner != any_peer && owner != host)
      continue;
    auto& feed = feeds_.open(host);
    if (feed.questions)
      continue; // it is the last in the row that is going out
    feed.questions = pending_feed::question_scan{unasked->serial, false};
    serve_now(host, now, out);
  }
}

void subscriber_feed::ask_all(peer_id host, bool refresh, instant now, tuple_events& out) {
  if (!hosts_.knows(host) || !local_.has_questions())
    return;
  begin_question_scan(host, refresh);
  serve_now(host, now, out);
}

void subscriber_feed::begin_question_scan(peer_id host, bool refresh) {
  auto& feed = feeds_.open(host);
  if (feed.questions)
    feed.questions_again = feed.questions_again.value_or(true) && refresh;
  else
    feed.questions = pending_feed::question_scan{0, refresh};
}

void subscriber_feed::on_host_appeared(peer_id host, instant now, tuple_events& out) {
  if (auto* feed = feeds_.find(host)) {
    feed->not_before.reset();
    plan(host, now);
  }
  ask_all(host, false, now, out);
}

void subscriber_feed::on_host_gone(peer_id host) {
  subscribers_.erase_host(host);
  feeds_.close(host);
  window_.drop(host);
  channels_.drop_subscriber(host);
}

void subscriber_feed::on_delivered(request_id request, instant now, tuple_events& out) {
  if (const auto x = window_.finish(request, true))
    serve_now(x->host, now, out);
  else if (auto next = channels_.on_delivered(request))
    out.push_back(std::move(*next));
}

void subscriber_feed::on_undelivered(peer_id destination, std::uint16_t port, byte_view head,
                                     request_id request, instant now) {
  const auto x = window_.finish(request, false);
  const bool of_channel = channels_.knows(request);
  if (!x && !of_channel)
    return; // of a host that is gone, or of another component
  const bool concerns_tuple = port == port::push || port == port::append_notice;
  const auto name = concerns_tuple ? decode_record_key(head) : result<key>(errc::unsupported);
  if (name && of_channel)
    collapse(*name, now);
  if (name) { // also to a host whose route is not known yet
    retry_later(destination, *name, x && x->failing_since ? *x->failing_since : now, now);
  } else if (x && x->question && hosts_.knows(destination)) {
    auto& feed = feeds_.open(destination);
    feed.undelivered_questions.insert(*x->question);
    feed.not_before = now + config_.retry_push;
    feeds_.schedule(destination, feed.not_before);
  }
}

void subscriber_feed::refresh(instant now, tuple_events& out) {
  if (!next_refresh_ || *next_refresh_ > now)
    return;
  next_refresh_.reset();
  const auto found = subscribers_.find_expired(now);
  for (const auto* x : found.gone) {
    end_queue_scan(x->host, x->number);
    subscribers_.erase(*x);
  }
  for (const auto& [host, known] : hosts_.known()) {
    if (known.marked)
      ask_all(host, true, now, out);
  }
  if (found.mortal || local_.size() > 0)
    next_refresh_ = now + config_.lifetime / refreshes_per_lifetime;
}

bool subscriber_feed::is_waiting(const key& name) const {
  const auto* held = own_.find(name);
  if (held == nullptr || feeds_.size() == 0)
    return false;
  return std::ranges::any_of(subscribers_.hosts_for(*held->content), [&](peer_id host) {
    const auto* feed = feeds_.find(host);
    return feed != nullptr &&
           (feed->undelivered.contains(name.folded()) || !feed->queue_scans.empty());
  });
}

tuple_counters subscriber_feed::counters() const {
  auto all = counters_;
  all.subscribers = subscribers_.size();
  all.subscribers_octets = subscribers_.octets();
  all.pushes_octets = window_.octets();
  all.debtors = feeds_.size();
  return all;
}

} // namespace rubicon::peis
