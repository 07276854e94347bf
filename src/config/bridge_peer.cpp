#include "config/bridge_peer.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/text/spelling.hpp"

namespace rubicon::config {

std::optional<std::string> bridge_peer::read(const node& x, const asker& who) {
  const auto* name = x.as<std::string>();
  if (name == nullptr)
    return who.refuse(x, "the name of a peer");
  std::vector<std::string> known;
  for (const auto& [each, id] : who.in.names->ends)
    if (who.in.names->island_of_gateway(id) == nullptr)
      known.push_back(each);
  if (std::ranges::find(known, *name) != known.end())
    return *name;
  if (who.in.names->ends.contains(*name)) {
    who.complain(x, '`' + *name +
                        "` is a gateway: a bridge needs a peer of its own, under "
                        "[[peer]], with a link to it");
    return std::nullopt;
  }
  who.complain(x, "no peer is named `" + *name + '`' + suggestion(*name, known));
  return std::nullopt;
}

void add_bridge(ecology_description& out, const std::string& peer, peer_app bridge) {
  const auto found = std::ranges::find(out.peers, peer, &peer_description::name);
  if (found != out.peers.end())
    found->apps.push_back(std::move(bridge));
}

} // namespace rubicon::config
