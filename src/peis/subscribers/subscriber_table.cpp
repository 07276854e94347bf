#include "peis/subscribers/subscriber_table.hpp"

#include <algorithm>
#include <tuple>
#include <type_traits>

namespace rubicon::peis {

namespace {

/// What a record takes beyond the octets that the subscriber has chosen: nodes of three trees, the
/// prototype and the key.
constexpr std::size_t record_overhead = 720;
constexpr std::size_t few_subscriptions = 64; ///< of one host: walked

std::size_t weight_of(const prototype& x, const std::string& identity) {
  return record_overhead + 2 * identity.size() + x.name.text().size() +
         (x.value ? x.value->size() : 0);
}

template <class Integer>
void append_integer(std::string& to, Integer x) {
  for (std::size_t i = 0; i < sizeof x; ++i)
    to.push_back(static_cast<char>(static_cast<std::uint64_t>(x) >> 8U * i));
}

} // namespace

std::string identity_of(const prototype& x) {
  std::string all = x.name.folded();
  all.push_back('\0'); // no key has one
  append_integer(all, x.owner.value);
  append_integer(all, x.creator.value);
  for (const auto& time : {x.written, x.user_time, x.expiry}) {
    append_integer(all, time.seconds);
    append_integer(all, time.microseconds);
  }
  all.push_back(static_cast<char>(x.form));
  all.push_back(static_cast<char>((x.mimetype ? 1 : 0) + (x.value ? 2 : 0)));
  append_integer(all, static_cast<std::uint64_t>(x.mimetype ? x.mimetype->size() : 0));
  all += x.mimetype.value_or("");
  if (!x.value)
    return all;
  append_integer(all, static_cast<std::uint64_t>(x.value->size()));
  for (const auto octet : x.value->view()) { // equal without letter case, up to the first NUL
    if (octet == 0)
      break;
    const bool capital = octet >= 'A' && octet <= 'Z';
    all.push_back(static_cast<char>(capital ? octet - 'A' + 'a' : octet));
  }
  return all;
}

subscriber_table::subscriber_table(const limits& x)
    : per_key_(x.per_key), count_(x.records), octets_(x.octets, x.pool) {}

subscriber* subscriber_table::find(peer_id host, const prototype& wanted) {
  const auto of_host = hosts_.find(host);
  if (of_host == hosts_.end())
    return nullptr;
  const auto at = of_host->second.by_identity.find(identity_of(wanted));
  return at == of_host->second.by_identity.end() ? nullptr : &at->second;
}

subscriber* subscriber_table::add(peer_id host, const prototype& wanted,
                                  std::optional<instant> expiry) {
  auto identity = identity_of(wanted);
  const auto weight = weight_of(wanted, identity);
  std::size_t of_key = 0;
  index_.for_equal(wanted.name, [&](const subscriber* x) { of_key += x->host == host ? 1 : 0; });
  if (of_key >= per_key_ || !count_.admits(host, 1) || !octets_.admits(host, weight))
    return nullptr;
  count_.add(host, 1);
  octets_.add(host, weight);
  auto& of_host = hosts_[host];
  auto& x = of_host.by_identity
                .emplace(std::move(identity),
                         subscriber{host, wanted, expiry, next_number_++, weight, false})
                .first->second;
  of_host.by_number.emplace_hint(of_host.by_number.end(), x.number, &x);
  index_.insert(wanted.name, &x);
  ++version_;
  return &x;
}

void subscriber_table::erase(const subscriber& x) {
  const auto of_host = hosts_.find(x.host);
  ++version_;
  index_.erase_if(x.wanted.name, [&](const subscriber* other) { return other == &x; });
  count_.remove(x.host, 1);
  octets_.remove(x.host, x.weight);
  of_host->second.by_number.erase(x.number);
  const auto at = of_host->second.by_identity.find(identity_of(x.wanted));
  of_host->second.by_identity.erase(at);
  if (of_host->second.by_identity.empty())
    hosts_.erase(of_host);
}

std::vector<std::uint64_t> subscriber_table::erase(peer_id host, peer_id owner, const key& wanted) {
  std::vector<const subscriber*> gone;
  index_.for_equal(wanted, [&](const subscriber* x) {
    if (x->host == host && x->wanted.owner == owner)
      gone.push_back(x);
  });
  std::vector<std::uint64_t> numbers;
  for (const auto* x : gone) {
    numbers.push_back(x->number);
    erase(*x);
  }
  return numbers;
}

std::size_t subscriber_table::erase_host(peer_id host) {
  const auto of_host = hosts_.find(host);
  if (of_host == hosts_.end())
    return 0;
  const auto count = of_host->second.by_number.size();
  ++version_;
  for (const auto& [number, x] : of_host->second.by_number)
    index_.erase_if(x->wanted.name, [gone = x](const subscriber* other) { return other == gone; });
  count_.remove(host, count);
  octets_.remove(host, octets_.of(host));
  hosts_.erase(of_host);
  return count;
}

subscriber_table::expired subscriber_table::find_expired(instant now) {
  expired found;
  for (auto& [host, of_host] : hosts_) {
    for (auto& [number, x] : of_host.by_number) {
      if (x->expiry && *x->expiry <= now)
        found.gone.push_back(x);
      else
        found.mortal = found.mortal || x->expiry;
    }
  }
  return found;
}

const subscriber_table::records* subscriber_table::of(peer_id host) const {
  const auto at = hosts_.find(host);
  return at == hosts_.end() ? nullptr : &at->second.by_number;
}

std::vector<peer_id> subscriber_table::hosts_for(const tuple& x) const {
  std::vector<peer_id> hosts;
  for_matching(x.name, [&](const subscriber& s) {
    if (x.expiry == deleted || s.wanted.matches(x))
      hosts.push_back(s.host);
  });
  std::sort(hosts.begin(), hosts.end());
  hosts.erase(std::unique(hosts.begin(), hosts.end()), hosts.end());
  return hosts;
}

/// Looks at what the host wants or at what is wanted of the tuple: others make either long.
bool subscriber_table::wants(peer_id host, const tuple& x) const {
  const auto* theirs = of(host);
  if (theirs == nullptr)
    return false;
  if (theirs->size() <= few_subscriptions) {
    return std::ranges::any_of(*theirs, [&](const auto& record) {
      const auto& wanted = record.second->wanted;
      return x.expiry == deleted ? wanted.name.matches(x.name) : wanted.matches(x);
    });
  }
  bool found = false;
  for_matching(x.name, [&](const subscriber& s) {
    found = found || (s.host == host && (x.expiry == deleted || s.wanted.matches(x)));
  });
  return found;
}

bool subscriber_table::covers(const key& name) const {
  bool found = false;
  for_matching(name, [&](const subscriber&) { found = true; });
  return found;
}

std::vector<prototype> subscriber_table::lasting_of(peer_id host, std::size_t count_max,
                                                    std::size_t octets_max) const {
  std::vector<prototype> lasting;
  const auto* theirs = of(host);
  if (theirs == nullptr)
    return lasting;
  std::size_t octets = 0;
  for (const auto& [number, s] : *theirs) {
    octets += s->weight;
    if (lasting.size() >= count_max || octets > octets_max)
      break;
    if (!s->expiry)
      lasting.push_back(s->wanted);
  }
  return lasting;
}

std::vector<std::pair<peer_id, prototype>> subscriber_table::all() const {
  std::vector<std::pair<peer_id, prototype>> found;
  for_all([&](const subscriber& x) { found.emplace_back(x.host, x.wanted); });
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second.owner, a.second.name.folded()) <
           std::tie(b.first, b.second.owner, b.second.name.folded());
  });
  return found;
}

} // namespace rubicon::peis
