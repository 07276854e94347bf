// What a kernel is made of.
#pragma once

#include <string>
#include <vector>

#include "peis/overlay/p2p_config.hpp"
#include "peis/space/tuple_space_config.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Only `network` is enough to start; `network.id` must be 1..65535.
struct kernel_config {
  p2p_config network; ///< id, names, network string, queue sizes, times
  tuple_space_config tuples;
  std::string user = "unknown";  ///< value of kernel.user
  std::vector<peer_id> managers; ///< may write our kernel.do-quit, besides peers of our host
};

} // namespace rubicon::peis
