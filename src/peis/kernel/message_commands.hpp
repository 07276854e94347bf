// Messages that the owner of a kernel sends and receives.
#pragma once

#include <cstdint>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/kernel/kernel_layers.hpp"
#include "peis/overlay/transit_hooks.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

class message_commands {
public:
  /// @param layers outlive this
  explicit message_commands(kernel_layers& layers) : layers_(layers) {}

  /// Sends up to 16 MiB to a user port of one peer (API-02). The outcome comes once (API-04).
  [[nodiscard]] outputs send(peer_id destination, std::uint16_t port, payload octets, bool reliable,
                             priority class_of_service, request_id request, instant now);

  /// Sends up to 1024 octets to every peer that can be reached (API-07). The outcome, if asked for,
  /// says only whether it was accepted.
  [[nodiscard]] outputs broadcast(std::uint16_t port, payload octets, request_id request,
                                  instant now);

  /// Requests the route that packages take to a host and back (API-12): `traced` follows, with an
  /// empty route if nothing came back within 5 s.
  [[nodiscard]] outputs trace(peer_id destination, request_id request, instant now);

  /// Messages for this port become outputs from now on; without this they are counted and dropped.
  /// @returns false unless the port is 20..49 (API-09)
  bool hook_port(std::uint16_t port);

  /// The hook sees what passes through this host on a port, and may stop it:
  /// p2p::set_transit_hook(). What it stops is output as `intercepted`. Messages for us are for
  /// hook_port().
  /// @returns false unless the port is 20..49 (API-09)
  bool hook_transit(std::uint16_t port, transit_hook hook);

private:
  kernel_layers& layers_;
};

} // namespace rubicon::peis
