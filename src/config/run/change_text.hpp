// Changes in words, and in the programs of a mote.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/plan/change.hpp"
#include "config/plan/ecology.hpp"

namespace rubicon::config {

/// `sampler 1`, `messenger 10`
[[nodiscard]] std::string program_text(const program_change& x);

/// `every 5 s, reliable true`
[[nodiscard]] std::string settings_text(const program_change& x);

/// `loss 30 %, gain -80 dB`
[[nodiscard]] std::string link_text(const link_change& x);

/// The present values of the settings that the change is about; nothing if none of the programs is
/// the one that it is about.
[[nodiscard]] std::optional<keys::key_changes> settings_before(const std::vector<mote_app>& apps,
                                                               const program_change& x);

/// @pre settings_before() finds the program
void apply(std::vector<mote_app>& apps, const program_change& x);

} // namespace rubicon::config
