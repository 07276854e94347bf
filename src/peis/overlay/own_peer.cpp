#include "peis/overlay/own_peer.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "peis/link/link.hpp"
#include "peis/wire/announcement.hpp"

namespace rubicon::peis {

own_peer::own_peer(p2p_config wanted, random_stream stream)
    : config(std::move(wanted)), rng(stream), ids(rng) {
  self.id = config.id;
  self.magic = ids.next();
  self.host_name = config.host_name;
  self.full_name = config.name + '@' + config.host_name + '!' + std::to_string(config.process);
  set_addresses(config.addresses);
  self.cluster = self.id.value;
  self.marked = true;
}

void own_peer::set_addresses(std::vector<low_level_address> all) {
  config.addresses = all;
  if (config.connections.leaf) // other hosts are not to come (LEA-01)
    std::erase_if(all, [](const auto& x) { return !x.loopback; });
  all.resize(std::min(all.size(), low_level_addresses_max));
  self.addresses = std::move(all);
}

bytes own_peer::hello() const {
  return encode(announcement{protocol_version, config.network, self});
}

package_header own_peer::fresh_header(package_type type, std::uint16_t port) {
  package_header header;
  header.id = header.ack_id = ids.next();
  header.type = type;
  header.source = self.id;
  header.port = port;
  return header;
}

} // namespace rubicon::peis
