#include "peis/media/simulated_lan.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "peis/wire/announcement.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t stations_many = 50; // of so many each receives only what is new
constexpr duration repeat_after = 30s;    // the longest period of announcements

} // namespace

bool simulated_lan::separates(const fault& x, peer_id a, peer_id b) {
  const auto group = [&x](peer_id id) {
    const auto found = x.groups.find(id);
    return found == x.groups.end() ? std::nullopt : std::optional(found->second); // the rest
  };
  return group(a) != group(b);
}

/// What the network does between two processes now.
link_condition simulated_lan::condition_between(const process& a, const process& b) const {
  link_condition x{!a.powered || !b.powered, 0};
  auto passing = 1 - loss_;
  for (const auto& [name, y] : faults_) {
    x.cut = x.cut || separates(y, a.id, b.id);
    if (y.lossy.empty() || (y.lossy.contains(a.id) && y.lossy.contains(b.id)))
      passing *= 1 - y.loss;
  }
  x.loss = 1 - passing;
  return x;
}

/// Notifies the ends of a link of what has changed for them: another condition, or that the process
/// at the far end is gone, if the computer there still says so.
/// @returns whether the link is no more
bool simulated_lan::settle(link_id number, connection& x, outputs& out) const {
  const auto& a = stations_.at(x.initiator);
  const auto& b = stations_.at(x.acceptor);
  const auto condition = condition_between(a, b);
  if (a.runs && b.runs) {
    if (std::exchange(x.condition, condition) != condition) {
      out.emplace_back(condition_set{x.initiator, number, condition});
      out.emplace_back(condition_set{x.acceptor, number, condition});
    }
    return false;
  }
  if (condition.cut)
    return !a.runs && !b.runs;
  if (a.runs)
    out.emplace_back(link_reset{x.initiator, number});
  if (b.runs)
    out.emplace_back(link_reset{x.acceptor, number});
  return true;
}

simulated_lan::outputs simulated_lan::settle_links() {
  outputs out;
  for (auto x = links_.begin(); x != links_.end();)
    x = settle(x->first, x->second, out) ? links_.erase(x) : std::next(x);
  std::erase_if(stations_, [this](const auto& x) {
    return !x.second.runs && x.second.powered && std::ranges::none_of(links_, [&x](const auto& y) {
      return y.second.initiator == x.first || y.second.acceptor == x.first;
    });
  });
  return out;
}

void simulated_lan::join(station_id station, peer_id id, bool hears) {
  stations_[station] = {id, hears};
  for (auto& [number, x] : stations_)
    std::erase(x.reached, station); // who comes has received nothing
}

simulated_lan::outputs simulated_lan::end(station_id station) {
  if (const auto found = stations_.find(station); found != stations_.end())
    found->second.runs = false;
  return settle_links();
}

/// Whether a computer without listener can refuse.
bool simulated_lan::can_refuse(const process& from, peer_id id) const {
  const bool powered = std::ranges::none_of(
      stations_, [id](const auto& x) { return x.second.id == id && !x.second.powered; });
  return !condition_between(from, {id, false, false, powered}).cut;
}

simulated_lan::outputs simulated_lan::connect(station_id station, attempt_id attempt, peer_id to) {
  const auto from = stations_.find(station);
  if (from == stations_.end() || !from->second.runs)
    return {};
  const auto listener = std::ranges::find_if(stations_, [&](const auto& x) {
    return x.second.id == to && x.second.runs && x.first != station;
  });
  if (listener == stations_.end()) {
    if (!can_refuse(from->second, to))
      return {};
    return {link_refused{station, attempt}};
  }
  const auto condition = condition_between(from->second, listener->second);
  if (condition.cut)
    return {};
  const link_id link{next_link_++};
  const auto acceptor = listener->first;
  links_[link] = {station, acceptor, condition};
  return {link_made{acceptor, station, link, link_role::acceptor, {}, condition},
          link_made{station, acceptor, link, link_role::initiator, attempt, condition}};
}

/// Who has an announcement already needs it no more, unless something has changed since. Others of
/// its computer count them.
simulated_lan::outputs simulated_lan::announce(station_id station, const payload& octets,
                                               instant now) {
  outputs out;
  const auto found = stations_.find(station);
  if (found == stations_.end())
    return out;
  auto& from = found->second;
  const bool large = stations_.size() >= stations_many;
  if (large)
    note_announced(from, octets, now);
  std::vector<station_id> reached;
  for (const auto& [number, other] : stations_) {
    if (number == station || !other.runs || !other.hears)
      continue;
    if (large && std::ranges::binary_search(from.reached, number) &&
        other.computer != from.computer) {
      reached.push_back(number);
      continue;
    }
    const auto condition = condition_between(from, other);
    if (condition.cut || rng_.chance(condition.loss))
      continue;
    out.emplace_back(announcement_heard{number, octets});
    reached.push_back(number);
  }
  if (large)
    from.reached = std::move(reached);
  return out;
}

void simulated_lan::note_announced(process& from, const payload& octets, instant now) const {
  const bool same = from.announced == octets;
  if (same && now < from.since + repeat_after)
    return;
  from.since = now;
  from.reached.clear();
  if (same)
    return;
  from.announced = octets;
  const auto x = decode_announcement(octets.view());
  from.computer = x ? x->sender.host_name : std::string();
}

/// Peers may have lost each other.
void simulated_lan::forget_announcements() {
  for (auto& [number, x] : stations_)
    x.reached.clear();
}

simulated_lan::outputs simulated_lan::set_power(station_id station, bool on) {
  const auto found = stations_.find(station);
  if (found == stations_.end())
    return {};
  found->second.powered = on;
  forget_announcements();
  return settle_links();
}

simulated_lan::outputs simulated_lan::begin_fault(std::uint64_t name, const lan_fault& x) {
  fault begun{{}, x.loss, {x.lossy.begin(), x.lossy.end()}};
  for (std::size_t i = 0; i < x.groups.size(); ++i) {
    for (const auto id : x.groups[i])
      begun.groups[id] = i;
  }
  faults_[name] = std::move(begun);
  forget_announcements();
  return settle_links();
}

simulated_lan::outputs simulated_lan::end_fault(std::uint64_t name) {
  faults_.erase(name);
  forget_announcements();
  return settle_links();
}

} // namespace rubicon::peis
