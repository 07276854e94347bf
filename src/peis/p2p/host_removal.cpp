#include "peis/p2p/host_removal.hpp"

#include <vector>

#include "peis/wire/host_query.hpp"

namespace rubicon::peis {

namespace {

constexpr int burial_periods = 3; ///< how long stale news of a host that left are ignored
constexpr int distrusted_periods =
    3; ///< what is no news of an earlier incarnation is ignored so long

} // namespace

void host_removal::remove(peer_id id, dead_host_message::reason why, const occasion& x) {
  const auto* known = on_.hosts.find(id);
  const auto* way = on_.routes.routes().find(id);
  if (known == nullptr && way == nullptr && !on_.links.is_neighbour(id))
    return;
  const auto magic = known != nullptr ? known->record.magic
                     : way != nullptr ? way->magic
                                      : any_magic;
  const bool exits = why == dead_host_message::reason::message;
  if (known != nullptr && !exits)
    on_.hosts.remember(known->record, x.now);
  on_.presence.forget(id, x);
  on_.contacts.forget(id);
  if (exits)
    on_.routes.routes().bury(id, magic, x.now + burial_periods * on_.own.config.routing_period);
  on_.routes.routes().erase(id);
  on_.closer.close_broken(on_.links.links_to(id), close_cause::host_left, x);
  on_.exchange.trigger(x.now);
}

void host_removal::supersede(peer_id id, std::int32_t magic, const occasion& x) {
  auto links = on_.links.links_to(id);
  std::erase_if(links, [&](link_id link) { return on_.links.at(link).magic != magic; });
  on_.closer.close_broken(links, close_cause::reborn, x);
  on_.presence.forget(id, x);
  on_.contacts.forget(id);
  auto& routes = on_.routes.routes();
  routes.distrust(id, magic, x.now + distrusted_periods * on_.own.config.routing_period);
  if (const auto* way = routes.find(id); way != nullptr && way->magic == magic)
    routes.erase(id);
  if (on_.routes.reachable(id))
    on_.presence.notify_forgotten(id, x);
  on_.exchange.trigger(x.now);
}

} // namespace rubicon::peis
