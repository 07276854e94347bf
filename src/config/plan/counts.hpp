// Which counts of a mote a field of its proxy can be.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "config/plan/ecology.hpp"

namespace rubicon::config {

/// Messages that may come to a gateway are not those of samplers and actuators alone.
[[nodiscard]] bool may_send_anything(const mote_description& mote);

using count_range = std::pair<std::int64_t, std::int64_t>;

/// The least and the greatest count that the mote's programs send for the field; nothing: no
/// program knows. Noise of a transducer counts with six of its deviations.
[[nodiscard]] std::optional<count_range> counts_of(const mote_description& mote,
                                                   const proxy::field& field);

} // namespace rubicon::config
