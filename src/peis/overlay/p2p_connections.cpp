// Whom to connect to: kept addresses, clusters, the connection manager, announcements (A9,
// peis-wire.md 4 and 14).
#include <algorithm>
#include <utility>

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

namespace {

constexpr duration merge_soon = 500ms; // after an attempt, while others wait
constexpr duration news_jitter = 50ms; // peers that start together do not all call at once
constexpr duration young_for = 10s;    // a link is not judged before (peis-wire.md 14)
constexpr duration merge_gap = 50us;   // for each host that must be looked at
constexpr duration former_for = 10min; // a lost host is looked for as long as this
constexpr std::size_t former_max = 256;
constexpr unsigned tries_max = 30;       // seconds between two tries of a host, at most
constexpr unsigned lost_tries_max = 2;   // the same, of one to which there is no way
constexpr unsigned foreign_runs_max = 3; // CLU-02
constexpr unsigned refusals_judged = 2;  // one may be a mistake: peis-wire.md 25.8
constexpr unsigned first_announcements = 3;
constexpr std::size_t announcers_max = 256;
constexpr std::uint64_t dial_cost = 5; // seconds of its sender's account
constexpr duration dial_burst = 50s;
constexpr unsigned quiet_periods = 3; // after these without a better announcer we announce
constexpr std::size_t referrals = 8;
constexpr std::uint8_t connections_max = 254; // 255 means unknown

/// The record of a host that is there, or was.
template <class Hosts, class Former>
const host_record* record_of(peer_id host, const Hosts& hosts, const Former& former) {
  if (const auto known = hosts.find(host); known != hosts.end())
    return &known->second.record;
  const auto gone = former.find(host);
  return gone == former.end() ? nullptr : &gone->second.record;
}

} // namespace

void p2p::connect(const std::string& url, attempt x, instant now) {
  const attempt_id id{next_attempt_++};
  const auto* known = x.host ? record_of(*x.host, hosts_, former_) : nullptr;
  const bool slow = known == nullptr || known->marked;
  x.deadline = now + (slow ? config_.connections.connect_timeout : config_.original_timeout);
  ++counters_.attempts;
  if (x.host)
    note_contact(*x.host, now);
  if (x.standing)
    standing_[*x.standing].trying = true;
  attempts_.emplace(id, x);
  events_.push_back(connect_to{id, url});
}

/// One of the addresses that can be reached from here, at random.
bool p2p::connect_host(const host_record& record, std::uint32_t flags, instant now) {
  const auto urls = urls_to(record);
  if (urls.empty() || open_links() + attempts_.size() >= config_.links_max)
    return false;
  charge_announcer(record.id, now);
  const auto& url = urls[urls.size() == 1 ? 0 : rng_.below(urls.size())];
  const bool is_here = url.find("://127.") != std::string::npos;
  connect(url, {flags, record.id, std::nullopt, {}, is_here}, now);
  return true;
}

void p2p::note_contact(peer_id host, instant now) {
  if (contacts_.size() >= config_.tables.contacts && !contacts_.contains(host)) {
    std::erase_if(contacts_, [now](const auto& x) {
      return x.second.last + std::chrono::seconds(x.second.tries) <= now;
    });
    if (contacts_.size() >= config_.tables.contacts)
      return; // it may be tried sooner than it should
  }
  auto& x = contacts_[host];
  x.tries = std::min(x.tries + 1, tries_max);
  x.last = now;
}

/// @param refusals before that which is waited for
duration p2p::refused_wait(unsigned refusals) const {
  auto wait = config_.connections.refused_retry;
  for (; refusals > 0 && wait < config_.connections.refused_retry_max; --refusals)
    wait *= 2;
  return std::min(wait, config_.connections.refused_retry_max);
}

/// From the second time on, it and others of its machine that refuse us are tried by one, and ever
/// more rarely: leaves that have lost their master are many.
void p2p::note_refusal(peer_id host, instant now) {
  const auto known = contacts_.find(host);
  const auto* record = record_of(host, hosts_, former_);
  if (known == contacts_.end() || record == nullptr)
    return;
  if (++known->second.refusals < refusals_judged)
    return;
  std::erase_if(refusing_, [now](const auto& x) { return x.second.until + former_for <= now; });
  if (refusing_.size() >= former_max && !refusing_.contains(record->host_name))
    return;
  auto& machine = refusing_[record->host_name];
  if (machine.until > now)
    return; // others were tried at the same time
  machine.until = now + refused_wait(machine.refusals);
  ++machine.refusals;
}

bool p2p::is_refused_at(peer_id host, instant now) const {
  const auto known = contacts_.find(host);
  if (known == contacts_.end() || known->second.refusals < refusals_judged)
    return false;
  const auto* record = record_of(host, hosts_, former_);
  const auto machine = record == nullptr ? refusing_.end() : refusing_.find(record->host_name);
  return machine != refusing_.end() && machine->second.until > now;
}

/// Whoever announces hosts that nobody has met may have us dial any address: of each sender of
/// announcements we follow a few, then one in dial_cost seconds. Those beyond the table share one.
rate_limit& p2p::announcer_of(const ipv4_address& from, instant now) {
  if (announcers_.size() >= announcers_max)
    std::erase_if(announcers_,
                  [now](const auto& x) { return x.second.free_at() + dial_burst <= now; });
  const bool full = announcers_.size() >= announcers_max && !announcers_.contains(from);
  return announcers_
      .try_emplace(full ? ipv4_address{} : from, rate_limit(1, dial_burst, dial_cost * 1s))
      .first->second;
}

bool p2p::has_credit(peer_id host, instant now) {
  const auto known = hosts_.find(host);
  return known == hosts_.end() || !known->second.announcer ||
         announcer_of(*known->second.announcer, now).free_at() <= now;
}

void p2p::charge_announcer(peer_id host, instant now) {
  if (const auto known = hosts_.find(host); known != hosts_.end() && known->second.announcer)
    announcer_of(*known->second.announcer, now).take(dial_cost, now);
}

/// No link, none asked for, and the time to try again has come (CM-10).
/// @param wait_max seconds between two tries
bool p2p::may_try(peer_id host, unsigned wait_max, instant now) {
  if (neighbours_.contains(host) || is_refused_at(host, now) || !has_credit(host, now))
    return false;
  const auto known = contacts_.find(host);
  if (known != contacts_.end()) {
    const auto& [tries, last, runs, refusals] = known->second;
    if (last + std::chrono::seconds(std::min(tries, wait_max)) > now)
      return false;
  }
  return std::none_of(attempts_.begin(), attempts_.end(),
                      [host](const auto& x) { return x.second.host == host; });
}

void p2p::on_attempt_failed(attempt_id id, instant now) {
  const auto at = attempts_.find(id);
  if (at == attempts_.end())
    return;
  const auto gone = at->second;
  attempts_.erase(at);
  on_attempt_ended(gone, false, now);
}

void p2p::on_attempt_ended(const attempt& x, bool success, instant now) {
  counters_.attempts_failed += success ? 0 : 1;
  if (!x.standing)
    return;
  auto& address = standing_[*x.standing];
  address.trying = false;
  if (!success) {
    address.next = now + address.wait;
    address.wait = std::min(2 * address.wait, config_.connections.always_retry_max);
  }
}

void p2p::check_attempts(instant now) {
  std::vector<attempt_id> late;
  for (const auto& [id, x] : attempts_) {
    if (x.deadline <= now)
      late.push_back(id);
  }
  for (const auto id : late)
    on_attempt_failed(id, now);
}

bool p2p::is_served(const standing_address& x) const {
  if (x.trying || x.link)
    return true;
  return x.host && (x.seed ? reachable(*x.host) : neighbours_.contains(*x.host));
}

void p2p::tend_standing(instant now) {
  for (std::size_t i = 0; i < standing_.size(); ++i) {
    const auto& x = standing_[i];
    if (is_served(x) || x.next > now)
      continue;
    const auto flags = x.seed ? connect_request::for_merge
                              : connect_request::all_broadcasts | connect_request::for_merge;
    const auto moved = x.elsewhere ? address_told_by(x) : std::nullopt;
    standing_[i].elsewhere = !x.elsewhere;
    connect(moved.value_or(x.url), {flags, moved ? x.host : std::nullopt, i, {}}, now);
  }
}

/// Another address of whoever answered there last: it may have come back on another port.
std::optional<std::string> p2p::address_told_by(const standing_address& x) {
  const auto* record = x.host ? record_of(*x.host, hosts_, former_) : nullptr;
  auto urls = record == nullptr ? std::vector<std::string>() : urls_to(*record);
  std::erase(urls, x.url);
  if (urls.empty())
    return std::nullopt;
  return urls[urls.size() == 1 ? 0 : rng_.below(urls.size())];
}

/// D1.1 3.1.6.5: force a connection to a host in a lower cluster; to one in a higher cluster only
/// if that side does not manage it, and to one that was lost whatever its cluster was.
void p2p::merge_clusters(instant now) {
  last_merge_ = now;
  next_merge_ = now + config_.connections.cluster_period;
  std::erase_if(former_, [&](const auto& x) { return x.second.lost + former_for <= now; });
  expire_hosts(now);
  std::vector<const host_record*> foreign;
  const auto consider = [&](const host_record& record, bool at_once) {
    if (reachable(record.id) || !may_try(record.id, lost_tries_max, now) || urls_to(record).empty())
      return;
    if (at_once || record.cluster < self_.cluster ||
        ++contacts_[record.id].runs_foreign >= foreign_runs_max)
      foreign.push_back(&record);
  };
  for (const auto& [id, x] : hosts_)
    consider(x.record, x.lost.has_value() || x.forgotten);
  for (const auto& [id, x] : former_)
    consider(x.record, true);
  if (foreign.empty())
    return;
  const auto& chosen = *foreign[rng_.below(foreign.size())];
  static_cast<void>(connect_host(chosen, connect_request::for_merge, now));
  next_merge_ = now + merge_soon;
}

void p2p::hasten_merge(instant now) {
  const auto soon = now + rng_.between(duration(0), news_jitter);
  next_merge_ = std::min(next_merge_,
                         std::max(soon, last_merge_ + static_cast<int>(hosts_.size()) * merge_gap));
}

/// CLU-01, CLU-03.
void p2p::update_cluster(instant now) {
  auto lowest = self_.id;
  for (const auto& [host, way] : routing_.routes()) {
    if (host > lowest)
      break;
    if (!way.lost()) {
      lowest = host;
      break;
    }
  }
  if (std::exchange(self_.cluster, lowest.value) != lowest.value)
    announce_by_rule(now, true);
}

bool p2p::busy_with(peer_id host) const {
  return traffic_.octets_per_second(host) > config_.connections.forced_octets_per_second;
}

void p2p::manage(instant now) {
  next_manager_ = now + config_.connections.manager_period;
  traffic_.measure(now);
  close_doubles(now);
  if (force_by_traffic(now))
    return;
  const auto decision = decide(link_options(now), host_options(now), config_.connections, rng_);
  if (const auto* open = std::get_if<open_link_to>(&decision)) {
    static_cast<void>(connect_host(hosts_.at(open->host).record, 0, now));
  } else if (const auto* worst = std::get_if<close_worst>(&decision)) {
    close(worst->link, close_cause::unneeded, now);
  }
}

/// One of two links between the same peers goes (CM-11). Of two marked ones the lower id decides,
/// so that they do not close both; a real one decides for itself, too.
void p2p::close_doubles(instant now) {
  std::map<peer_id, const connection*> kept;
  std::vector<link_id> doubles;
  const auto better = [&](const connection& a, const connection& b) {
    if (is_doubtful(a, now) != is_doubtful(b, now))
      return is_doubtful(b, now);
    return a.always() != b.always() ? a.always() : a.opened < b.opened;
  };
  for (const auto& [link, x] : connections_) {
    if (!x.open || !x.named || (is_marked(x) && *x.neighbour < self_.id))
      continue;
    auto& best = kept[*x.neighbour];
    if (best == nullptr) {
      best = &x;
    } else if (better(x, *best)) {
      doubles.push_back(std::exchange(best, &x)->id);
    } else {
      doubles.push_back(link);
    }
  }
  for (const auto link : doubles)
    close(link, close_cause::double_link, now);
}

/// CM-03.
bool p2p::force_by_traffic(instant now) {
  for (const auto& [id, x] : hosts_) {
    if (busy_with(id) && may_try(id, tries_max, now) &&
        connect_host(x.record, connect_request::for_bandwidth, now))
      return true;
  }
  return false;
}

std::vector<link_option> p2p::link_options(instant now) const {
  std::vector<link_option> options;
  for (const auto& [link, x] : connections_) {
    if (!x.open || x.always())
      continue;
    link_option option{link, std::nullopt};
    if (x.neighbour && x.opened + young_for <= now && !busy_with(*x.neighbour))
      option.loss = routing_.loss_without(link);
    options.push_back(option);
  }
  return options;
}

std::vector<host_option> p2p::host_options(instant now) {
  std::vector<host_option> options;
  for (const auto& [id, x] : hosts_) {
    const auto* way = routing_.find(id);
    if (way == nullptr || way->lost() || !may_try(id, tries_max, now) || urls_to(x.record).empty())
      continue;
    const auto direct = is_here(x.record) ? config_.cost_same_host : config_.cost_other_host;
    const unsigned connections =
        way->connections == connections_unknown ? config_.connections.links_min : way->connections;
    options.push_back({id, way->hops, direct, connections});
  }
  return options;
}

std::uint8_t p2p::own_connections() const {
  return static_cast<std::uint8_t>(std::min<std::size_t>(open_links(), connections_max));
}

/// Every peer says three times that it has come. From then on only the one with the lowest id of
/// each machine goes on (peis-wire.md 4, A-16).
void p2p::announce_by_rule(instant now, bool extra) {
  if (!config_.connections.announces || left_ || rivalry_.is_away())
    return;
  const bool first = first_announcements_ < first_announcements;
  if (!extra) {
    next_announcement_ = now + config_.connections.announce_period;
    unheard_announcements_ = std::min(unheard_announcements_ + 1, quiet_periods);
    first_announcements_ += first ? 1 : 0;
  }
  if (!first && unheard_announcements_ < quiet_periods)
    return;
  ++counters_.announcements_sent;
  events_.push_back(announce{hello()});
}

void p2p::on_announcement(byte_view octets, instant now, std::optional<ipv4_address> from) {
  const auto news = decode_announcement(octets);
  if (!news) {
    ++counters_.malformed;
    return;
  }
  const auto& sender = news->sender;
  if (news->version != protocol_version || news->network != config_.network || left_)
    return;
  if (sender.id == self_.id) {
    if (sender.magic != self_.magic)
      note_duplicate(sender, now);
    return;
  }
  if (rivalry_.is_away())
    return;
  ++counters_.announcements_received;
  if (is_here(sender) && sender.id < self_.id)
    unheard_announcements_ = 0;
  const auto last = hosts_.find(sender.id);
  const bool is_new = last == hosts_.end();
  const bool is_back = !is_new && last->second.record.magic != sender.magic;
  const bool has_moved = !is_new && last->second.record.addresses != sender.addresses;
  if (is_back) {
    if (reachable(sender.id))
      return; // a route, or its own word, tells which of the two is there
    supersede(sender.id, last->second.record.magic, now);
  }
  auto* known = acquaint(sender.id);
  if (known == nullptr)
    return;
  const bool is_news = (is_new || is_back || has_moved) && !reachable(sender.id);
  if (is_news)
    known->announcer = from;
  if (is_back)
    known->lost = now; // as one that was lost, it is not left to others to connect to
  if (has_moved && is_news)
    contacts_.erase(sender.id); // tried in vain where it was
  if (may_dial_none(sender))
    ++counters_.announcements_foreign;
  known->heard = known->own_word = now;
  known->record = sender;
  recall(*known);
  if (is_news)
    hasten_merge(now);
}

/// There is no room for this peer: it is told who we are and whom else it may ask (TCP-07).
void p2p::refer_elsewhere(connection& to, instant now) {
  std::vector<const host_record*> known{&self_};
  for (const auto& [id, x] : hosts_) {
    if (reachable(id) && !x.record.addresses.empty())
      known.push_back(&x.record);
  }
  for (std::size_t i = 1; i < known.size() && i <= referrals; ++i)
    std::swap(known[i], known[i + rng_.below(known.size() - i)]);
  known.resize(std::min(known.size(), referrals + 1));
  for (const auto* record : known)
    tell_neighbour(to, port::host_record, encode(host_record_message{*record, true}));
  to.open = true;
  static_cast<void>(write(to, now));
}

/// The host cannot be reached any more, but it may be found again where it was.
void p2p::remember(const host_record& record, instant now) {
  if (former_.size() < former_max || former_.contains(record.id))
    former_[record.id] = {record, now};
}

bool p2p::manages() const {
  return config_.connections.manager && !config_.connections.leaf && !left_;
}

/// Is there anything that the manager could change?
bool p2p::manager_wanted() const {
  return hosts_.size() > neighbours_.size() || connections_.size() > neighbours_.size() ||
         connections_.size() > config_.connections.links_suitable;
}

bool p2p::merge_wanted() const {
  return !former_.empty() || !missing_.empty() || hosts_.size() > welcomed_;
}

void p2p::tend_connections(instant now) {
  if (left_)
    return;
  check_attempts(now);
  tend_bluetooth(now);
  tend_standing(now);
  if (config_.connections.announces && next_announcement_ <= now)
    announce_by_rule(now, false);
  if (!manages())
    return;
  if (merge_wanted() && next_merge_ <= now)
    merge_clusters(now);
  if (manager_wanted() && next_manager_ <= now)
    manage(now);
}

std::optional<instant> p2p::connections_deadline() const {
  if (left_)
    return std::nullopt;
  auto next = bluetooth_.deadline();
  for (const auto& [id, x] : attempts_)
    next = earliest(next, x.deadline);
  for (const auto& x : standing_) {
    if (!is_served(x))
      next = earliest(next, x.next);
  }
  if (config_.connections.announces)
    next = earliest(next, next_announcement_);
  if (manages() && merge_wanted())
    next = earliest(next, next_merge_);
  if (manages() && manager_wanted())
    next = earliest(next, next_manager_);
  return next;
}

} // namespace rubicon::peis
