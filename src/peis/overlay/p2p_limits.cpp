// What tables that others fill have room for. The rule is one: a link may have as many entries as
// are free beside them, so that there is always room for another (docs/security.md).
#include <algorithm>
#include <utility>

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

namespace {

constexpr duration unreachable_for = 60s; // a host that is told of no more is forgotten
constexpr work_units room_work = 50;      // of a search for room
constexpr duration room_gap = 100ms;      // before another search for the same link

} // namespace

/// Half of the table is anybody's; beyond, what each link has told of must be counted.
bool p2p::has_room_for_host(link_id from) {
  const auto max = config_.tables.hosts;
  if (hosts_.size() < max / 2)
    return true;
  work_.add(room_work);
  const auto told = [&] {
    return static_cast<std::size_t>(
        std::ranges::count_if(hosts_, [&](const auto& x) { return x.second.from == from; }));
  };
  if (hosts_.size() < max && told() < max - hosts_.size())
    return true;
  // Those that only a closed link has told of go first.
  std::erase_if(hosts_, [&](const auto& x) {
    const auto& [id, host] = x;
    return host.from != by_announcement && !connections_.contains(host.from) && !host.announced &&
           !reachable(id);
  });
  return hosts_.size() < max && told() < max - hosts_.size();
}

/// The entry of a host; a new one, if there is room. @returns null if there is none
p2p::acquaintance* p2p::acquaint(peer_id id) {
  if (const auto known = hosts_.find(id); known != hosts_.end())
    return &known->second;
  const auto from = serving_.value_or(by_announcement);
  const auto teller = connections_.find(from);
  const bool searched = teller != connections_.end() && latest_ < teller->second.no_room_until;
  if (searched || !has_room_for_host(from)) {
    if (!searched && teller != connections_.end())
      teller->second.no_room_until = latest_ + room_gap;
    ++counters_.hosts_refused;
    return nullptr;
  }
  auto& x = hosts_[id];
  x.from = from;
  return &x;
}

void p2p::expire_hosts(instant now) {
  std::erase_if(hosts_, [&](const auto& x) {
    return !x.second.announced && !reachable(x.first) && x.second.heard + unreachable_for <= now;
  });
}

bool p2p::may_answer(link_id from) const {
  const auto open = answers_.find(from);
  return answers_open_ < config_.tables.answers &&
         (open == answers_.end() ? 0 : open->second) < config_.tables.answers - answers_open_;
}

void p2p::on_message_ended(const reliable_message& x) {
  const auto open = x.for_neighbour ? answers_.find(*x.for_neighbour) : answers_.end();
  if (open == answers_.end())
    return;
  --answers_open_;
  if (--open->second == 0)
    answers_.erase(open);
}

/// Where sources without a way were last heard: of each link the newest.
void p2p::note_heard(peer_id source, link_id over) {
  if (way_to(source)) {
    heard_over_.erase(source);
    return;
  }
  const auto [at, is_new] = heard_over_.try_emplace(source, over);
  if (!is_new && at->second == over)
    return;
  at->second = over;
  auto& heard = connections_.at(over).heard;
  heard.push_back(source);
  if (heard.size() <= config_.tables.heard_over)
    return;
  const auto oldest = heard_over_.find(heard.front());
  heard.pop_front();
  if (oldest != heard_over_.end() && oldest->second == over && oldest->first != source)
    heard_over_.erase(oldest);
}

std::size_t p2p::open_links() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(connections_, [](const auto& x) { return x.second.open; }));
}

/// The link that has waited longest for its request.
void p2p::evict_greeting() {
  const connection* oldest = nullptr;
  for (const auto& [link, x] : connections_) {
    if (!x.open && (oldest == nullptr || x.opened < oldest->opened))
      oldest = &x;
  }
  if (oldest == nullptr)
    return;
  ++counters_.greetings_evicted;
  ++counters_.links_refused;
  close(oldest->id, close_cause::handshake_silent, latest_);
}

} // namespace rubicon::peis
