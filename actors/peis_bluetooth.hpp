// Simulated Bluetooth between the machines of peers (BT-02, A-17): which adapters and devices are
// where, who announces on an adapter, which links are open. Octets do not pass through here: the
// ends of a link send them to each other.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "actors/messages.hpp"
#include "config/ecology.hpp"

namespace rubicon {

/// Links over Bluetooth have numbers from here on, below first_real_link.
inline constexpr std::uint64_t first_bluetooth_link = std::uint64_t{1} << 62;

struct peis_bluetooth_state {
  /// An adapter of a machine, or a device that is no peer.
  struct adapter {
    std::string machine; ///< empty: none of a peer
    position place;
    std::vector<std::uint64_t> stations;    ///< that have opened it, in that order
    std::optional<std::uint64_t> announcer; ///< of them: it alone makes all of them known (BT-03)
    std::set<std::uint64_t> dark;           ///< stations whose power has gone
  };

  struct station {
    bluetooth_user_actor user;
    std::map<std::string, peis::bluetooth_address> adapters; ///< by name
    std::uint16_t port = 0;
  };

  struct link {
    std::uint64_t initiator = 0; ///< stations
    std::uint64_t acceptor = 0;
    peis::bluetooth_address from; ///< adapters
    peis::bluetooth_address to;
  };

  config::peis_description network;
  std::map<peis::bluetooth_address, adapter> adapters;
  std::map<std::uint64_t, station> stations; ///< that run
  std::map<std::uint64_t, link> links;
  std::uint64_t next_link = first_bluetooth_link;
};

/// Each adapter of a machine has an address of its own, made up of the two names.
[[nodiscard]] peis::bluetooth_address address_of_adapter(const std::string& machine,
                                                         const std::string& adapter);

/// The n-th port of a machine where links are taken; as L2CAP asks for, the low octet is odd and
/// the high one even.
[[nodiscard]] std::uint16_t bluetooth_port(std::size_t n);

/// In whole dBm, as adapters tell it.
[[nodiscard]] int bluetooth_strength_dbm(double distance_m);

peis_bluetooth_actor::behavior_type
peis_bluetooth(scheduler::traced_pointer<peis_bluetooth_state, peis_bluetooth_actor> self,
               config::peis_description network, std::vector<config::bluetooth_device> others);

} // namespace rubicon
