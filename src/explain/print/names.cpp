#include "explain/print/names.hpp"

namespace rubicon::explain {

names::names(const header& about) {
  for (const auto& [id, name] : about.peers) {
    const peer_id peer{id};
    peers_[peer] = name;
    kernels_["peis_peer/" + name] = peer;
    const mote_address pc{island_id(static_cast<std::uint32_t>(id)), no_mote};
    motes_[pc] = name;
    actors_["pc/" + name] = pc;
    paths_[pc] = "pc/" + name;
    places_["pc/" + name] = "peis_peer/" + name;
  }
  for (const auto& island : about.islands) {
    const island_id id(island.id);
    const auto add = [&](mote_id mote, const std::string& name, const std::string& path) {
      motes_[{id, mote}] = island.name + '/' + name;
      actors_[path] = {id, mote};
      paths_[{id, mote}] = path;
    };
    add(no_mote, "gateway", "gateway/" + island.name);
    for (const auto& alias : island.aliases) { // the same address, whichever of them leads
      const auto path = "gateway/" + island.name + '/' + alias;
      actors_[path] = {id, no_mote};
      places_[path] = "peis_peer/" + alias;
      for (const auto& [peer, name] : about.peers)
        if (name == alias)
          speaks_for_[peer_id{peer}] = gateway_of(id);
    }
    add(mote_id(island.sink), "sink", "sink/" + island.name);
    sinks_[id] = mote_id(island.sink);
    actors_["mote/" + island.name + "/sink"] = {id, mote_id(island.sink)}; // one that only measures
    places_["gateway/" + island.name] = "peis_peer/" + island.gateway;
    for (const auto& [mote, name] : island.motes)
      add(mote_id(mote), name, "mote/" + island.name + '/' + name);
    for (const auto& [name, mote] : island.doubles)
      actors_["mote/" + island.name + '/' + name] = {id, mote_id(mote)};
  }
}

std::string names::of(mote_address x) const {
  const auto found = motes_.find(x);
  if (found != motes_.end())
    return found->second;
  if (x.mote == broadcast_mote) {
    const auto sink = sinks_.find(x.island);
    const auto name = sink == sinks_.end() ? to_string(x.island) : of({x.island, sink->second});
    return "all of " + name.substr(0, name.find('/'));
  }
  return to_string(x);
}

std::string names::of(peer_id x) const {
  const auto found = peers_.find(x);
  return found == peers_.end() ? "peer " + to_string(x) : found->second;
}

std::string names::of(std::string_view path) {
  const auto slash = path.find('/');
  if (slash == std::string_view::npos)
    return std::string(path);
  const auto kind = path.substr(0, slash);
  const auto rest = std::string(path.substr(slash + 1));
  if (kind == "proxy")
    return "proxy " + rest;
  if (kind == "sink" || kind == "gateway" || kind == "proxy_manager")
    return rest + '/' + std::string(kind);
  return rest;
}

std::optional<mote_address> names::address_of(std::string_view path) const {
  const auto found = actors_.find(path);
  return found == actors_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<peer_id> names::peer_of(std::string_view path) const {
  const auto found = kernels_.find(path);
  return found == kernels_.end() ? std::nullopt : std::optional(found->second);
}

std::string names::gateway_at(std::string_view line, island_id island) const {
  const auto slash = line.find('/');
  const auto path =
      slash == std::string_view::npos ? std::string() : "gateway" + std::string(line.substr(slash));
  return actors_.contains(path) ? path : path_of({island, no_mote});
}

std::string names::path_of(mote_address x) const {
  const auto found = paths_.find(x);
  return found == paths_.end() ? std::string() : found->second;
}

std::string names::place_of(const std::string& path) const {
  const auto found = places_.find(path);
  return found == places_.end() ? path : found->second;
}

peer_id names::speaks_for(peer_id x) const {
  const auto found = speaks_for_.find(x);
  return found == speaks_for_.end() ? x : found->second;
}

mote_id names::sink_of(island_id x) const {
  const auto found = sinks_.find(x);
  return found == sinks_.end() ? default_sink : found->second;
}

} // namespace rubicon::explain
