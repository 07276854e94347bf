// The state that the parts of a kernel share.
#pragma once

#include <cstdint>

#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "peis/kernel/indirections.hpp"
#include "peis/kernel/kernel_config.hpp"
#include "peis/kernel/kernel_events.hpp"
#include "peis/kernel/kernel_statistics.hpp"
#include "peis/kernel/message_ports.hpp"
#include "peis/p2p/p2p.hpp"
#include "peis/space/tuple_space.hpp"
#include "peis/tuples/quit_requests.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// The two layers, and what is kept beside them. kernel_turn joins them.
struct kernel_layers {
  kernel_layers() = default;
  kernel_layers(kernel_config wanted, random_stream rng, instant now);

  [[nodiscard]] peer_id self() const { return config.network.id; }

  /// Why a command about this key is refused, if it is; a malformed key is counted.
  [[nodiscard]] cause refusal(const result<key>& name);

  [[nodiscard]] kernel_counters counters() const;

  kernel_config config;
  p2p network;
  tuple_space tuples;
  kernel_statistics statistics;
  indirections indirect;
  quit_requests quits;
  message_ports ports;
  std::uint64_t refused = 0; ///< commands
  outputs out;               ///< of turns, until one of them finishes
};

} // namespace rubicon::peis
