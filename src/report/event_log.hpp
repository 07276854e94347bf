// Which lines of an event log stay when there are too many of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "report/report.hpp"

namespace rubicon::report {

/// Adds the newest line. Of more than `lines_max` the one goes whose neighbours are nearest to each
/// other in time: what is left is spread over the whole run, and the first and the last line stay.
/// @param left_out counts those that went
/// @pre lines_max > 2
void add_event(std::vector<logged_event>& log, std::uint64_t& left_out, logged_event x,
               std::size_t lines_max = event_log_max);

/// The same of all at once. @returns how many went
std::uint64_t thin(std::vector<logged_event>& log, std::size_t lines_max);

} // namespace rubicon::report
