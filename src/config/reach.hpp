// Whether radios that all reach equally far connect every mote of an island with its sink.
#pragma once

#include <cstddef>
#include <vector>

#include "core/address.hpp"

namespace rubicon::config {

/// @param range_m > 0
/// @returns indices, ascending, of the places that no chain of places with steps of at most
/// `range_m` connects with `from`
[[nodiscard]] std::vector<std::size_t>
out_of_reach(const position& from, const std::vector<position>& places, double range_m);

} // namespace rubicon::config
