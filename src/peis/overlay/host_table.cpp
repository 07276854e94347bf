#include "peis/overlay/host_table.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr duration unreachable_for = 60s; // a host that no peer mentions any more is forgotten
constexpr work_units room_work = 50;      // of a search for room
constexpr duration room_gap = 100ms;      // before another search for the same link
constexpr duration former_for = 10min;    // a lost host is looked for as long as this
constexpr std::size_t former_max = 256;

} // namespace

host_table::host_table(own_peer& own, link_table& links, const overlay& routes)
    : own_(own), links_(links), overlay_(routes) {}

host_entry* host_table::find(peer_id id) {
  const auto known = hosts_.find(id);
  return known == hosts_.end() ? nullptr : &known->second;
}

const host_entry* host_table::find(peer_id id) const {
  const auto known = hosts_.find(id);
  return known == hosts_.end() ? nullptr : &known->second;
}

/// Half of the table is for all links; beyond, what each link has brought must be counted.
bool host_table::has_room_for(link_id from) {
  const auto max = own_.config.tables.hosts;
  if (hosts_.size() < max / 2)
    return true;
  own_.work.add(room_work);
  const auto brought = [&] {
    return static_cast<std::size_t>(
        std::ranges::count_if(hosts_, [&](const auto& x) { return x.second.from == from; }));
  };
  if (hosts_.size() < max && brought() < max - hosts_.size())
    return true;
  // Those that only a closed link has brought go first.
  std::erase_if(hosts_, [&](const auto& x) {
    const auto& [id, host] = x;
    return host.from != host_entry::by_announcement && !links_.contains(host.from) &&
           !host.announced && !overlay_.reachable(id);
  });
  return hosts_.size() < max && brought() < max - hosts_.size();
}

host_entry* host_table::admit(peer_id id, const occasion& x) {
  if (auto* known = find(id))
    return known;
  const auto from = x.origin == own_origin ? host_entry::by_announcement : x.origin;
  auto* over = links_.find(from);
  const bool searched = over != nullptr && x.now < over->no_room_until;
  if (searched || !has_room_for(from)) {
    if (!searched && over != nullptr)
      over->no_room_until = x.now + room_gap;
    ++own_.counters.hosts_refused;
    return nullptr;
  }
  auto& added = hosts_[id];
  added.from = from;
  return &added;
}

void host_table::erase(peer_id id) {
  missing_.erase(id);
  const auto known = hosts_.find(id);
  if (known == hosts_.end())
    return;
  announced_ -= known->second.announced ? 1 : 0;
  hosts_.erase(known);
}

void host_table::expire(instant now) {
  std::erase_if(hosts_, [&](const auto& x) {
    return !x.second.announced && !overlay_.reachable(x.first) &&
           x.second.last_record + unreachable_for <= now;
  });
}

void host_table::note_announced(host_entry& x) {
  x.announced = true;
  ++announced_;
}

void host_table::note_lost(peer_id id, instant now) {
  auto* known = find(id);
  if (known == nullptr || known->lost || overlay_.reachable(id))
    return;
  known->lost = now;
  if (known->announced)
    missing_.insert(id);
}

std::optional<instant> host_table::note_found(host_entry& x) {
  missing_.erase(x.record.id);
  return std::exchange(x.lost, std::nullopt);
}

void host_table::remember(const host_record& x, instant now) {
  if (former_.size() < former_max || former_.contains(x.id))
    former_[x.id] = {x, now};
}

void host_table::recall(host_entry& x) {
  const auto former = former_.find(x.record.id);
  if (former == former_.end())
    return;
  x.forgotten = x.forgotten || former->second.record.magic == x.record.magic;
  former_.erase(former);
}

void host_table::expire_former(instant now) {
  std::erase_if(former_, [&](const auto& x) { return x.second.lost + former_for <= now; });
}

const host_record* host_table::record_of(peer_id host) const {
  if (host == own_.self.id)
    return &own_.self;
  const auto* known = find(host);
  return known == nullptr ? nullptr : &known->record;
}

const host_record* host_table::last_record_of(peer_id host) const {
  if (const auto* known = find(host))
    return &known->record;
  const auto gone = former_.find(host);
  return gone == former_.end() ? nullptr : &gone->second.record;
}

std::vector<const host_record*> host_table::records() const {
  std::vector<const host_record*> all{&own_.self};
  for (const auto& [id, x] : hosts_)
    all.push_back(&x.record);
  std::sort(all.begin(), all.end(), [](const auto* a, const auto* b) { return a->id < b->id; });
  return all;
}

bool host_table::knows_present(peer_id id) const {
  const auto* known = find(id);
  if (known == nullptr)
    return false;
  const auto* way = overlay_.routes().find(id);
  if (way != nullptr && !way->lost())
    return way->magic == known->record.magic;
  return links_.is_neighbour(id);
}

bool host_table::is_marked(peer_id id) const {
  const auto* known = find(id);
  return known != nullptr && known->record.marked;
}

bool host_table::is_here(const host_record& x) const {
  const auto known = elsewhere_.find(x.id);
  return x.host_name == own_.self.host_name &&
         (known == elsewhere_.end() || known->second != x.magic);
}

bool host_table::shares_host(peer_id host) const {
  const auto* record = record_of(host);
  return record != nullptr && is_here(*record);
}

/// Either another has taken its place, or it is on another computer. That has network addresses,
/// and none of ours.
bool host_table::note_elsewhere(peer_id host) {
  const auto* known = find(host);
  if (known == nullptr || !is_here(known->record))
    return false;
  const auto remote = [](const host_record& x) {
    std::set<std::array<std::uint8_t, 4>> all;
    for (const auto& each : x.addresses)
      if (each.type == low_level_address::kind::tcp_ipv4 && !each.loopback)
        all.insert({each.address[0], each.address[1], each.address[2], each.address[3]});
    return all;
  };
  const auto ours = remote(own_.self);
  const auto its = remote(known->record);
  if (its.empty() || std::ranges::any_of(its, [&](const auto& x) { return ours.contains(x); }))
    return false;
  constexpr std::size_t elsewhere_max = 256;
  if (elsewhere_.size() >= elsewhere_max)
    elsewhere_.clear(); // they are found again
  elsewhere_[host] = known->record.magic;
  return true;
}

} // namespace rubicon::peis
