#include "peis/p2p/matchmaker.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <variant>

namespace rubicon::peis {

namespace {

constexpr duration merge_soon = 500ms; // after an attempt, while others wait
constexpr duration news_jitter = 50ms; // peers that start together do not all call at once
constexpr duration young_for = 10s;    // a link is not judged before (peis-wire.md 14)
constexpr duration merge_gap = 50us;   // for each host that must be looked at
constexpr duration sign_wait = 5s;     // for a sign of life, before another way is looked for
constexpr unsigned host_wait_max = 30; // seconds between two tries of a host, at most
constexpr unsigned lost_wait_max = 2;  // the same, of one to which there is no route
constexpr duration judging_gap = 1s;
constexpr duration naming_time = 5s; ///< to say who one is, on a link that one has asked for

} // namespace

bool matchmaker::has_room_for(const connect_request& request, const occasion& x) {
  if (of_.links.open() >= of_.own.config.links_max)
    return replace_least(x);
  // What a link is worth takes a walk over all ways: only if it decides, and not for each who asks.
  const bool judged =
      (request.flags & connect_request::for_bandwidth) != 0 && x.now >= next_judgement_;
  std::vector<link_option> options;
  if (judged) {
    options = link_options(x.now);
  } else {
    for (const auto& [link, each] : of_.links.all()) {
      if (each.open && !each.always())
        options.push_back({link, std::nullopt});
    }
  }
  switch (admit(request.flags, options, of_.own.config.connections)) {
  case admission::accept:
    return true;
  case admission::refuse:
    next_judgement_ = judged ? x.now + judging_gap : next_judgement_;
    return false;
  case admission::replace_worst:
    of_.closer.close(worst_of(options)->link, close_cause::unneeded, x);
    return true;
  }
  return false;
}

/// All links are in use. One whose neighbour has asked for it and never said who it is goes, or one
/// that leads nowhere that others do not lead; these are not judged anew for each who asks.
bool matchmaker::replace_least(const occasion& x) {
  for (const auto& [link, each] : of_.links.all()) {
    if (each.asked_at && *each.asked_at + naming_time <= x.now && !each.named) {
      of_.closer.close(link, close_cause::nameless, x);
      return true;
    }
  }
  if (x.now < next_judgement_)
    return false;
  const auto worst = worst_of(link_options(x.now));
  if (!worst) {
    next_judgement_ = x.now + judging_gap;
    return false;
  }
  of_.closer.close(worst->link, close_cause::unneeded, x);
  return true;
}

/// D1.1 3.1.6.5: force a connection to a host in a lower cluster; to one in a higher cluster only
/// if that side does not manage it, and to one that was lost whatever its cluster was.
void matchmaker::merge_clusters(const occasion& x) {
  last_merge_ = x.now;
  next_merge_ = x.now + of_.own.config.connections.cluster_period;
  of_.hosts.expire_former(x.now);
  of_.hosts.expire(x.now);
  std::vector<const host_record*> foreign;
  const auto consider = [&](const host_record& record, bool at_once) {
    if (of_.routes.reachable(record.id) || !of_.dials.may_try(record.id, lost_wait_max, x.now) ||
        of_.dials.urls_to(record).empty())
      return;
    if (at_once || record.cluster < of_.own.self.cluster ||
        of_.contacts.note_foreign_run(record.id))
      foreign.push_back(&record);
  };
  // One that is offered, but has yet to give a sign of life, may have a route in a moment.
  const auto awaited = [&](peer_id id, instant lost) {
    return x.now < lost + sign_wait && !of_.routes.hops_to(id).empty();
  };
  for (const auto& [id, each] : of_.hosts.all())
    if (!each.lost || (*each.lost + host_entry::reroute_time <= x.now && !awaited(id, *each.lost)))
      consider(each.record, each.lost.has_value() || each.forgotten);
  for (const auto& [id, each] : of_.hosts.former())
    if (!awaited(id, each.lost))
      consider(each.record, true);
  if (foreign.empty())
    return;
  const auto& chosen = *foreign[of_.own.rng.below(foreign.size())];
  static_cast<void>(of_.dials.connect(chosen, connect_request::for_merge, x));
  next_merge_ = x.now + merge_soon;
}

void matchmaker::hasten_merge(instant now) {
  const auto soon = now + of_.own.rng.between(duration(0), news_jitter);
  const auto hosts = static_cast<int>(of_.hosts.all().size());
  next_merge_ = std::min(next_merge_, std::max(soon, last_merge_ + hosts * merge_gap));
}

bool matchmaker::busy_with(peer_id host) const {
  return of_.traffic.octets_per_second(host) > of_.own.config.connections.forced_octets_per_second;
}

void matchmaker::manage(const occasion& x) {
  auto& own = of_.own;
  next_manager_ = x.now + own.config.connections.manager_period;
  of_.traffic.measure(x.now);
  close_doubles(x);
  if (force_by_traffic(x))
    return;
  const auto& config = own.config.connections;
  const auto count = static_cast<std::size_t>(std::ranges::count_if(
      of_.links.all(), [this](const auto& each) { return is_lasting(each.second); }));
  if (count <= config.links_suitable)
    of_.exchange.end_drains(); // no link is one too many any more
  if (count == config.links_suitable)
    return; // whatever they are worth
  auto links = link_options(x.now);
  std::erase_if(links, [this](const auto& each) { return !is_lasting(of_.links.at(each.link)); });
  const auto hosts = count < config.links_suitable ? host_options(count < config.links_min, x.now)
                                                   : std::vector<host_option>();
  const auto decision = decide(links, hosts, config, own.rng);
  if (const auto* open = std::get_if<open_link_to>(&decision)) {
    static_cast<void>(of_.dials.connect(of_.hosts.find(open->host)->record, 0, x));
  } else if (std::holds_alternative<close_worst>(decision)) {
    release(std::move(links), x);
  }
}

/// Is that link one of those whose number the manager looks after? Not one that the neighbour is
/// about to close: another may take its place.
bool matchmaker::is_lasting(const connection& x) const {
  const bool ends = x.routes.drained && of_.health.is_marked(x) && !of_.exchange.drained_at(x.id);
  return x.open && !x.always() && !ends;
}

/// Closes the worst of too many links. In a large network many have routes over it: they are given
/// time to take others, for all at once that are too many.
void matchmaker::release(std::span<const link_option> links, const occasion& x) {
  std::vector<link_option> kept;
  for (const auto& option : links) {
    if (!tend_drain(option, x))
      kept.push_back(option);
  }
  const auto& own = of_.own.config;
  while (kept.size() > own.connections.links_suitable) {
    const auto worst = worst_of(kept);
    if (!worst)
      return;
    if (of_.hosts.all().size() < hosts_many || !of_.health.is_marked(of_.links.at(worst->link))) {
      of_.closer.close(worst->link, close_cause::unneeded, x);
      return;
    }
    const auto period = own.routing_period;
    of_.exchange.drain(worst->link, x.now + of_.own.rng.between(period, 2 * period));
    std::erase_if(kept, [&](const link_option& each) { return each.link == worst->link; });
  }
}

/// Closes a link whose time has come, unless it has become the only way to some host.
/// @returns whether it is closed, or to be closed
bool matchmaker::tend_drain(const link_option& x, const occasion& at) {
  const auto until = of_.exchange.drained_at(x.link);
  if (!until)
    return false;
  const bool is_needed = !x.loss || !of_.routes.routes().loss_without(x.link);
  if (is_needed || *until <= at.now)
    of_.exchange.end_drain(x.link);
  if (!is_needed && *until <= at.now)
    of_.closer.close(x.link, close_cause::unneeded, at);
  return !is_needed;
}

bool matchmaker::is_better(const connection& a, const connection& b, instant now) const {
  if (of_.health.is_suspect(a, now) != of_.health.is_suspect(b, now))
    return of_.health.is_suspect(b, now);
  return a.always() != b.always() ? a.always() : a.opened < b.opened;
}

/// One of two links between the same peers goes (CM-11). Of two marked ones the lower id decides,
/// so that they do not close both; a real one decides for itself, too.
void matchmaker::close_doubles(const occasion& x) {
  std::map<peer_id, const connection*> kept;
  std::vector<link_id> doubles;
  for (const auto& [link, each] : of_.links.all()) {
    if (!each.open || !each.named ||
        (of_.health.is_marked(each) && *each.neighbour < of_.own.self.id))
      continue;
    auto& best = kept[*each.neighbour];
    if (best == nullptr) {
      best = &each;
    } else if (is_better(each, *best, x.now)) {
      doubles.push_back(std::exchange(best, &each)->id);
    } else {
      doubles.push_back(link);
    }
  }
  for (const auto link : doubles)
    of_.closer.close(link, close_cause::double_link, x);
}

/// CM-03.
bool matchmaker::force_by_traffic(const occasion& x) {
  const auto limit = of_.own.config.connections.forced_octets_per_second;
  return std::ranges::any_of(of_.traffic.above(limit), [&](peer_id id) {
    const auto* known = of_.hosts.find(id);
    return known != nullptr && of_.dials.may_try(id, host_wait_max, x.now) &&
           of_.dials.connect(known->record, connect_request::for_bandwidth, x);
  });
}

std::vector<link_option> matchmaker::link_options(instant now) const {
  std::vector<link_option> options;
  for (const auto& [link, x] : of_.links.all()) {
    if (!x.open || x.always())
      continue;
    link_option option{link, std::nullopt};
    if (x.neighbour && x.opened + young_for <= now && !busy_with(*x.neighbour))
      option.loss = of_.routes.routes().loss_without(link);
    const auto* way = x.neighbour ? of_.routes.routes().find(*x.neighbour) : nullptr;
    if (way != nullptr && way->connections != connections_unknown)
      option.connections = way->connections;
    options.push_back(option);
  }
  return options;
}

/// @param full_ones those as well that have as many links as they want
std::vector<host_option> matchmaker::host_options(bool full_ones, instant now) {
  const auto& config = of_.own.config;
  std::vector<host_option> options;
  for (const auto& [id, x] : of_.hosts.all()) {
    const auto* way = of_.routes.routes().find(id);
    if (way == nullptr || way->lost())
      continue;
    const unsigned connections =
        way->connections == connections_unknown ? config.connections.links_min : way->connections;
    const bool full = connections >= config.connections.links_suitable;
    if ((full && !full_ones) || !of_.dials.may_try(id, host_wait_max, now) ||
        of_.dials.urls_to(x.record).empty())
      continue;
    const auto direct =
        of_.hosts.is_here(x.record) ? config.cost_same_host : config.cost_other_host;
    options.push_back({id, way->hops, direct, connections});
  }
  return options;
}

bool matchmaker::manages() const {
  const auto& own = of_.own;
  return own.config.connections.manager && !own.config.connections.leaf && !own.left;
}

/// Is there anything that the manager could change?
bool matchmaker::manager_wanted() const {
  const auto neighbours = of_.links.neighbours();
  return of_.hosts.all().size() > neighbours || of_.links.size() > neighbours ||
         of_.links.size() > of_.own.config.connections.links_suitable;
}

void matchmaker::on_time(const occasion& x) {
  if (!manages())
    return;
  if (of_.hosts.has_unreachable() && next_merge_ <= x.now)
    merge_clusters(x);
  if (manager_wanted() && next_manager_ <= x.now)
    manage(x);
}

std::optional<instant> matchmaker::deadline() const {
  if (!manages())
    return std::nullopt;
  std::optional<instant> next;
  if (of_.hosts.has_unreachable())
    next = earliest(next, next_merge_);
  if (manager_wanted())
    next = earliest(next, next_manager_);
  return next;
}

} // namespace rubicon::peis
