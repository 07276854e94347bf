// Where a running ecology is, for commands without --connect.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include "cli/network/temporary_peer.hpp"
#include "cli/words/network_command.hpp"
#include "io/loop.hpp"
#include "io/udp/udp_group.hpp"

namespace rubicon::cli {

/// Where to search, and for how long.
struct search_area {
  std::uint16_t first_port = 8000; ///< of this computer's loopback address
  std::uint16_t ports = 10; ///< so many from there on, as peers count up (docs/peis-wire.md 3.1)
  duration try_max = 2s;    ///< for each of them to answer
  /// Announcements received within `listen_for` (docs/peis-wire.md 4). At the loopback interface
  /// those of this computer are received, and nothing leaves it.
  io::udp_group_config group = {.interfaces = {"127.0.0.1"}};
  duration listen_for = 2500ms; ///< peers announce themselves every second
};

struct joined_network {
  network_options with; ///< the place, and the network's name
  std::unique_ptr<temporary_peer> self;
};

/// Joins the peer given in `options`, or else the network that it finds: of a run of this user on
/// this computer or of a deployment of this user, at this computer's default ports, or that
/// announces itself, in this order.
/// @returns why that failed, and which option to use
[[nodiscard]] std::variant<joined_network, std::string>
join_network(io::loop& where, network_options options, search_area area = {});

} // namespace rubicon::cli
