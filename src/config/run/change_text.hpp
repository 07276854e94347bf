// Changes in words, and in the programs of a mote.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/plan/change.hpp"
#include "config/plan/ecology.hpp"

namespace rubicon::config {

/// `sampler 1`, `messenger 10`
[[nodiscard]] std::string program_text(const rate_change& x);

/// `loss 30 %, gain -80 dB`
[[nodiscard]] std::string link_text(const link_change& x);

/// The period of the program that the change is about; nothing if none of them is.
[[nodiscard]] std::optional<duration> period_of(const std::vector<mote_app>& apps,
                                                const rate_change& x);

/// @pre period_of() finds one
void set_period(std::vector<mote_app>& apps, const rate_change& x);

} // namespace rubicon::config
