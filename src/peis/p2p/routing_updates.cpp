#include "peis/p2p/routing_updates.hpp"

#include <chrono>

#include "peis/wire/dead_host.hpp"

namespace rubicon::peis {

namespace {

constexpr int probe_burial = 30; // seconds that disproved news are ignored
// The same, of a host of another kind: others of that kind go on counting (peis-wire.md 9.4).
constexpr int original_burial = 120;

} // namespace

void routing_updates::on_page(link_id from, byte_view data, const occasion& x) {
  auto& link = on_.links.at(from);
  if (on_.exchange.on_page(link, data, x.now))
    apply_table(link, x);
}

void routing_updates::apply_table(connection& from, const occasion& x) {
  const auto link = from.id;
  const auto at = x.over(link);
  on_.presence.apply(on_.exchange.apply(from, at.now), at);
  on_.replacer.end_suspects_beside(link, at);
  auto& routes = on_.routes.routes();
  for (const auto host : routes.take_evicted()) {
    if (!on_.routes.reachable(host))
      on_.removal.remove(host, dead_host_message::reason::route, at);
  }
  if (routes.take_overtaken())
    on_.exchange.trigger(at.now);
}

void routing_updates::apply_waiting(const occasion& x) {
  for (const auto link : on_.exchange.take_waiting(x.now)) {
    if (!on_.exchange.may_apply(link, x.now))
      continue;
    apply_table(on_.links.at(link), x);
    static_cast<void>(on_.own.work.take()); // no link is being served
  }
}

void routing_updates::on_period(const occasion& x) {
  if (!on_.exchange.is_period_over(x.now))
    return;
  on_.exchange.begin_period(x.now);
  for (const auto id : on_.routes.routes().age(x.now))
    on_.removal.remove(id, dead_host_message::reason::route, x);
  on_.exchange.send(x);
  on_.hosts.expire(x.now);
  on_.inquiry.review(x.now);
}

void routing_updates::disprove(const way_disproved& x, const occasion& at) {
  const auto* record = on_.hosts.record_of(x.host);
  const bool marked = record != nullptr && record->marked;
  const std::chrono::seconds burial(marked ? probe_burial : original_burial);
  const auto changes = on_.routes.routes().unanswered(x.host, x.since, at.now + burial);
  on_.own.counters.ways_disproved += changes.size();
  on_.presence.apply(changes, at);
}

void routing_updates::on_sign_of_life(peer_id host, const occasion& x) {
  const auto changes = on_.routes.routes().on_sign_of_life(host);
  if (!changes.empty())
    on_.presence.apply(changes, x);
}

void routing_updates::remove_lost(const occasion& x) {
  const auto due = loss_deadline();
  if (!due || *due > x.now)
    return;
  const auto& routes = on_.routes.routes();
  for (const auto host : routes.lost_since(x.now - on_.own.config.lost_timeout))
    on_.removal.remove(host, dead_host_message::reason::route, x);
}

std::optional<instant> routing_updates::loss_deadline() const {
  const auto first = on_.routes.routes().first_loss();
  return first ? std::optional(*first + on_.own.config.lost_timeout) : std::nullopt;
}

} // namespace rubicon::peis
