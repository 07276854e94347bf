// Whether a tick has slots for what the motes of an island send at it (SYN-16).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/plan/ecology.hpp"
#include "config/toml/problem.hpp"
#include "mote/vector_slot.hpp"
#include "radio/mac_rules.hpp"

namespace rubicon::config {

/// What medium access adds to a frame in the island: of the slowest of its radios.
[[nodiscard]] network::access_times access_of(const radio::channel_config& radio,
                                              const island_description& island);

/// Calls `visit(const radio::mac_rules&, const radio::access_parameters&)` with the medium access
/// of the sink and of each mote, and their own parameters, where both are known.
template <class Visit>
void each_medium_access(const radio::channel_config& radio, const island_description& island,
                        Visit visit) {
  const auto look = [&](const auto& node) {
    const auto* rules = node.platform == nullptr ? nullptr : radio::mac_of(radio, *node.platform);
    if (rules != nullptr)
      visit(*rules, node.access);
  };
  look(island.sink);
  for (const auto& mote : island.motes)
    look(mote);
}

/// The slot that a mote's vectors need.
struct slot_need {
  std::string mote;
  std::uint16_t units = 0;
  std::vector<mote::vector_flow> flows; ///< never empty
  mark at;                              ///< where the file has its programs
};

/// Of all motes that send vectors to others, ascending by id.
/// @param range_m how far all radios reach; nothing: unknown, so that each channel may have one hop
[[nodiscard]] std::vector<slot_need> slot_needs(const island_description& island,
                                                std::optional<double> range_m,
                                                const network::access_times& access,
                                                const std::map<mote_id, mark>& programs_at);

/// Complains, with the sum, if the slots do not fit a tick.
void check_slots(const std::vector<slot_need>& needs, duration tick, complaints& problems);

} // namespace rubicon::config
