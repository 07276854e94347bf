// The peer itself, as every part of its network layer sees it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "peis/link/id_source.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/overlay/p2p_config.hpp"
#include "peis/overlay/p2p_counters.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

/// Its record and configuration, the numbers that it gives to packages, and what its parts add up
/// together.
struct own_peer {
  own_peer(p2p_config wanted, random_stream stream);

  /// Where we listen from now on.
  void set_addresses(std::vector<low_level_address> all);

  /// Our announcement, which HELLO connections carry as well.
  [[nodiscard]] bytes hello() const;

  /// Of a package of ours.
  [[nodiscard]] package_header fresh_header(package_type type, std::uint16_t port);

  p2p_config config;
  random_stream rng;
  id_source ids;
  host_record self;
  bool left = false; ///< the network
  p2p_counters counters;
  work_meter work; ///< of the package that is handled
};

} // namespace rubicon::peis
