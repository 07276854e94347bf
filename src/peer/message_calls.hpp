// How a program sends and receives messages over a peer that it drives by itself.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peer/callback_table.hpp"
#include "peer/callbacks.hpp"
#include "peis/kernel/kernel.hpp"

namespace rubicon::peer {

class standalone;

/// Names in brackets are those of D1.1 3.1.3.
class message_calls {
public:
  /// All outlive this.
  message_calls(standalone& peer, peis::kernel& kernel, callback_table& callbacks)
      : peer_(peer), kernel_(kernel), callbacks_(callbacks) {}

  /// [sendMessage] To one port of one peer.
  peis::cause send(std::uint16_t port, peer_id destination, payload octets, bool reliable,
                   peis::priority class_of_service = peis::priority::normal,
                   outcome_callback then = {});

  /// [broadcast] To all peers.
  [[nodiscard]] peis::cause broadcast(std::uint16_t port, payload octets);

  /// [registerHook] Several hooks of a port are called in the order they came in.
  /// @returns false unless the port is 20..49
  [[nodiscard]] bool register_hook(std::uint16_t port, message_callback hook);

  /// [registerHook] The same for packages that pass through here to others (API-06): one
  /// hook a port, which may consume them.
  [[nodiscard]] bool register_transit_hook(std::uint16_t port, peis::transit_hook hook);

  /// The peers on the route to a host and back, ourselves first (API-12). nullopt: none came back.
  [[nodiscard]] std::optional<std::vector<peer_id>> trace(peer_id destination, duration timeout);

private:
  standalone& peer_;
  peis::kernel& kernel_;
  callback_table& callbacks_;
};

} // namespace rubicon::peer
