#include "peis/links/dialler.hpp"

#include <algorithm>
#include <utility>

#include "peis/overlay/connection_manager.hpp"

namespace rubicon::peis {

namespace {

constexpr duration retry_after_loss = 1s; // a real kernel cuts a reborn peer off once (25.8)

} // namespace

dialler::dialler(own_peer& own, const link_table& links, const overlay& routes,
                 const host_table& hosts, contact_history& contacts, const bluetooth& adapters,
                 instant now)
    : own_(own), links_(links), overlay_(routes), hosts_(hosts), contacts_(contacts),
      adapters_(adapters) {
  const auto& wanted = own.config.connections;
  for (const auto* urls : {&wanted.always, &wanted.seeds}) {
    for (const auto& url : *urls)
      standing_.push_back({url, urls == &wanted.seeds, wanted.always_retry, now, false, {}, {}});
  }
}

void dialler::dial(const std::string& url, attempt x, const occasion& at) {
  const attempt_id id{next_attempt_++};
  const auto* known = x.host ? hosts_.last_record_of(*x.host) : nullptr;
  const bool slow = known == nullptr || known->marked;
  x.deadline =
      at.now + (slow ? own_.config.connections.connect_timeout : own_.config.original_timeout);
  ++own_.counters.attempts;
  if (x.host)
    contacts_.note_contact(*x.host, at.now);
  if (x.standing)
    standing_[*x.standing].trying = true;
  attempts_.emplace(id, x);
  at.out.push_back(connect_to{id, url});
}

bool dialler::connect(const host_record& record, std::uint32_t flags, const occasion& x) {
  const auto urls = urls_to(record);
  if (urls.empty() || links_.open() + attempts_.size() >= own_.config.links_max)
    return false;
  contacts_.charge_announcer(record.id, x.now);
  const auto& url = urls[urls.size() == 1 ? 0 : own_.rng.below(urls.size())];
  const bool is_here = url.find("://127.") != std::string::npos;
  dial(url, {flags, record.id, std::nullopt, {}, is_here}, x);
  return true;
}

/// At the address that is kept, if it is a link of one.
void dialler::connect_beside(const connection& x, const host_record& record, const occasion& at) {
  if (const auto kept = standing_of(x.id))
    dial(standing_[*kept].url, {x.request_flags, *x.neighbour, kept, {}}, at);
  else
    static_cast<void>(connect(record, connect_request::for_merge, at));
}

std::vector<std::string> dialler::urls_to(const host_record& other) const {
  auto seen = other;
  if (!hosts_.is_here(other) && other.host_name == own_.self.host_name)
    seen.host_name.clear(); // as one of another host
  std::erase_if(seen.addresses, [this](const auto& x) { return !may_dial(x); });
  auto own = own_.self;
  own.addresses = own_.config.addresses; // a leaf describes less of itself
  return connectable_urls(own, seen, adapters_);
}

/// Addresses that others send are tried in listed networks only.
bool dialler::may_dial(const low_level_address& x) const {
  const auto& networks = own_.config.connections.networks;
  using kind = low_level_address::kind;
  if (networks.empty() || (x.type != kind::tcp_ipv4 && x.type != kind::udp_ipv4))
    return true;
  const ipv4_address address{x.address[0], x.address[1], x.address[2], x.address[3]};
  return std::ranges::any_of(networks, [&](const auto& each) { return each.contains(address); });
}

bool dialler::may_dial_none(const host_record& x) const {
  return !x.addresses.empty() &&
         std::ranges::none_of(x.addresses, [this](const auto& each) { return may_dial(each); });
}

bool dialler::may_try(peer_id host, unsigned wait_max, instant now) {
  return contacts_.may_try(host, wait_max, now) && !is_seeking(host);
}

bool dialler::is_seeking(peer_id host) const {
  return std::ranges::any_of(attempts_, [host](const auto& x) { return x.second.host == host; });
}

std::optional<attempt> dialler::take(attempt_id id) {
  auto taken = attempts_.extract(id);
  return taken.empty() ? std::nullopt : std::optional(taken.mapped());
}

void dialler::on_opened(const attempt& x, link_id link) {
  if (!x.standing)
    return;
  standing_[*x.standing].trying = false;
  standing_[*x.standing].link = link;
}

void dialler::on_attempt_failed(attempt_id id, instant now) {
  const auto gone = take(id);
  if (!gone)
    return;
  ++own_.counters.attempts_failed;
  if (!gone->standing)
    return;
  auto& address = standing_[*gone->standing];
  address.trying = false;
  address.next = now + address.wait;
  address.wait = std::min(2 * address.wait, own_.config.connections.always_retry_max);
}

std::optional<std::size_t> dialler::standing_of(link_id link) const {
  const auto at = std::ranges::find(standing_, std::optional(link), &standing_address::link);
  return at == standing_.end() ? std::nullopt
                               : std::optional(static_cast<std::size_t>(at - standing_.begin()));
}

void dialler::on_record(const connection& x, const host_record& record, bool own_word, bool cached,
                        instant now) {
  const auto standing = standing_of(x.id);
  if (!standing)
    return;
  auto& address = standing_[*standing];
  if (own_word && x.tried_for && record.id != *x.tried_for) {
    address.link.reset(); // another peer is where its host was
    address.next = now + own_.config.connections.always_retry_max;
  } else if (!cached || !x.neighbour) {
    address.host = x.neighbour.value_or(record.id); // a referral begins with who refers
    address.wait = cached ? address.wait : own_.config.connections.always_retry;
  }
}

void dialler::on_link_closed(link_id link, instant now) {
  if (const auto standing = standing_of(link)) {
    standing_[*standing].link.reset();
    standing_[*standing].next = now + retry_after_loss;
  }
}

void dialler::note_end(std::size_t standing, bool refused, bool lasted, instant now) {
  auto& x = standing_[standing];
  x.refusals = refused ? x.refusals + 1 : lasted ? 0 : x.refusals;
  if (refused && x.refusals > 1) {
    const auto wait = contacts_.refused_wait(x.refusals - 2);
    x.next = now + own_.rng.between(wait * 3 / 4, wait * 5 / 4); // many are refused in one moment
  }
}

void dialler::abandon() {
  attempts_.clear();
  for (auto& x : standing_)
    x.trying = false;
}

void dialler::on_time(instant now) {
  std::vector<attempt_id> late;
  for (const auto& [id, x] : attempts_) {
    if (x.deadline <= now)
      late.push_back(id);
  }
  for (const auto id : late)
    on_attempt_failed(id, now);
}

bool dialler::is_served(const standing_address& x) const {
  if (x.trying || x.link)
    return true;
  return x.host && (x.seed ? overlay_.reachable(*x.host) : links_.is_neighbour(*x.host));
}

void dialler::dial_standing(const occasion& x) {
  for (std::size_t i = 0; i < standing_.size(); ++i) {
    auto& address = standing_[i];
    if (is_served(address) || address.next > x.now)
      continue;
    const auto flags = address.seed ? connect_request::for_merge
                                    : connect_request::all_broadcasts | connect_request::for_merge;
    const auto moved = address.elsewhere ? other_address(address) : std::nullopt;
    address.elsewhere = !address.elsewhere;
    dial(moved.value_or(address.url), {flags, moved ? address.host : std::nullopt, i, {}}, x);
  }
}

/// Another address of the peer that answered there last: it may have come back on another port.
std::optional<std::string> dialler::other_address(const standing_address& x) {
  const auto* record = x.host ? hosts_.last_record_of(*x.host) : nullptr;
  auto urls = record == nullptr ? std::vector<std::string>() : urls_to(*record);
  std::erase(urls, x.url);
  if (urls.empty())
    return std::nullopt;
  return urls[urls.size() == 1 ? 0 : own_.rng.below(urls.size())];
}

std::optional<instant> dialler::deadline() const {
  std::optional<instant> next;
  for (const auto& [id, x] : attempts_)
    next = earliest(next, x.deadline);
  for (const auto& x : standing_) {
    if (!is_served(x))
      next = earliest(next, x.next);
  }
  return next;
}

} // namespace rubicon::peis
