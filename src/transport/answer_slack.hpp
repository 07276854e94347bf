// What time-outs between two nodes must allow for where frames wait for radios that sleep.
#pragma once

#include <map>
#include <memory>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::transport {

/// Of the motes of one island, as configured: both ends of a tunnel come to the same figures,
/// whether a radio happens to sleep at the moment or not.
struct answer_slack {
  duration there_and_back{}; ///< what answers take longer, over as many hops as are likely
  duration period{};         ///< of the windows in which all their packets go
};

/// By island; nullptr: all radios are on. Islands whose radios are on need not be there.
using answer_slacks = std::shared_ptr<const std::map<island_id, answer_slack>>;

/// @returns nothing for a gateway or PC, whose radios need none
[[nodiscard]] inline answer_slack slack_of(const answer_slacks& all, mote_address end) {
  if (!all || end.mote == no_mote)
    return {};
  const auto found = all->find(end.island);
  return found == all->end() ? answer_slack{} : found->second;
}

} // namespace rubicon::transport
