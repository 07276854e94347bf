#include "config/plan/directory.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace rubicon::config {

std::shared_ptr<const directory> nobody_yet() {
  return std::make_shared<const directory>();
}

std::string default_mote_name(std::string_view type_name, mote_id id) {
  return (type_name.empty() ? "mote" : std::string(type_name)) + '-' + to_string(id);
}

std::string default_gateway_name(std::string_view island) {
  return std::string(island) + "-gateway";
}

std::string default_alias_name(std::string_view island, std::size_t number) {
  return default_gateway_name(island) + '-' + std::to_string(number);
}

std::string counted_peer_name(std::string_view name, std::uint32_t number) {
  return std::string(name) + '-' + std::to_string(number);
}

directory::directory(const ecology_description& all) {
  for (const auto& each : all.islands) {
    if (each.name.empty())
      continue;
    island found;
    found.id = each.id;
    found.sink = each.sink.id;
    found.has_gateway = has_line(each.stack);
    found.is_joined = each.stack == stack::full;
    for (const auto& mote : each.motes)
      found.motes.emplace(mote.name, mote.id);
    found.is_simulated = !each.outside.has_sink();
    if (found.has_gateway && !each.outside.has_gateway()) {
      found.gateways = gateways_of(each);
      ends.emplace(each.gateway_name, gateway_of(each.id));
      for (const auto& alias : each.aliases)
        ends.emplace(alias.name, alias.id);
    }
    islands.emplace(each.name, std::move(found));
  }
  for (const auto& each : all.peers) {
    if (!each.name.empty())
      ends.emplace(each.name, each.id);
    if (!each.table.empty())
      peer_groups[each.table].push_back(each.id);
  }
  for (const auto& each : all.hosts)
    hosts.insert(each.name);
  for (const auto& each : all.smepp.groups)
    groups.insert(each.name);
}

const directory::island* directory::island_of_gateway(peer_id id) const {
  const auto found = std::find_if(islands.begin(), islands.end(), [id](const auto& x) {
    const auto& gateways = x.second.gateways;
    return std::find(gateways.begin(), gateways.end(), id) != gateways.end();
  });
  return found == islands.end() ? nullptr : &found->second;
}

const directory::island* directory::find(island_id id) const {
  const auto found = std::find_if(islands.begin(), islands.end(),
                                  [id](const auto& x) { return x.second.id == id; });
  return found == islands.end() ? nullptr : &found->second;
}

} // namespace rubicon::config
