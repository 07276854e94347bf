#include "peis/p2p/id_guard.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr duration alive_within = 1500ms; // of a marked neighbour's last word: it beats each second

} // namespace

std::optional<link_id> id_guard::living_link(peer_id id, std::optional<link_id> except,
                                             instant now) const {
  const auto* known = hosts_.find(id);
  if (known == nullptr || !known->record.marked || !links_.is_neighbour(id))
    return std::nullopt;
  const auto at = std::ranges::find_if(links_.all(), [&](const auto& entry) {
    const auto& x = entry.second;
    return x.id != except && x.open && x.named && x.neighbour == id &&
           x.magic == known->record.magic && now - x.in.last_octets < alive_within;
  });
  return at == links_.all().end() ? std::nullopt : std::optional(at->first);
}

bool id_guard::is_impersonation(link_id from, const package_header& header, instant now) const {
  if (header.port != port::dead_host && header.port != port::host_record)
    return false;
  const auto* known = hosts_.find(header.source);
  if (known == nullptr || !links_.is_neighbour(header.source))
    return false;
  const auto& x = links_.at(from);
  const bool introduces_itself = !x.named && header.port == port::host_record;
  const bool is_its_own = x.named && x.neighbour == header.source && x.magic == known->record.magic;
  const bool believed = header.hops <= 1 && (introduces_itself || is_its_own);
  return !believed && living_link(header.source, from, now);
}

/// A newcomer with the id of a neighbour that has sent something just now is sent away; after a
/// restart the earlier incarnation has been silent when its successor tries again.
bool id_guard::refuse_rival(connection& from, const host_record& record, const occasion& x) {
  auto* known = hosts_.find(record.id);
  if (known == nullptr || !known->record.marked || known->record.magic == record.magic)
    return false;
  const auto alive = living_link(record.id, from.id, x.now);
  if (!alive)
    return false;
  ++own_.counters.rivals_refused;
  ++own_.counters.links_refused;
  if (std::exchange(known->rival, record.magic) != record.magic)
    known->rival_first = x.now;
  if (known->rival_first + alive_within <= x.now) { // a successor would be in by now
    notify_taken(links_.at(*alive), record, x.origin);
    notify_taken(from, known->record, x.origin);
  }
  // Who receives who we are takes this for no refusal of links.
  static_cast<void>(writer_.write(from, x.now, x.out));
  closer_.close(from.id, close_cause::own_id, x);
  return true;
}

/// One that was followed by another describes itself again: both are there.
void id_guard::notify_rivals(link_id from, const host_record& record) {
  const auto* known = hosts_.find(record.id);
  if (known == nullptr || known->before != record.magic || known->record.magic == record.magic)
    return;
  const auto& other = known->record;
  sender_.send_to_host(record.id, from, lane::high, port::host_record,
                       encode(host_record_message{other, true}), from);
  for (auto& [link, x] : links_.all()) {
    if (link != from && x.open && x.neighbour == record.id && x.magic == other.magic)
      notify_taken(x, record, from);
  }
}

void id_guard::notify_taken(connection& to, const host_record& by, link_id origin) {
  sender_.send_to_neighbour(to, port::host_record, encode(host_record_message{by, true}), origin);
}

} // namespace rubicon::peis
