// What a gateway reports to the ecology.
#pragma once

#include "actors/services/gateway.hpp"

namespace rubicon {

using gateway_pointer = scheduler::actor_pointer<gateway_state, gateway_actor>;

/// PEIS id of its kernel.
[[nodiscard]] peer_id id_of(gateway_pointer self);

/// While it runs: all that it has counted, whether it leads, and the motes that it lists if so.
void report_gateway(gateway_pointer self);

/// The same when its life ends.
void report_end(gateway_pointer self);

} // namespace rubicon
