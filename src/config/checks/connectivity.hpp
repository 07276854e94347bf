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
disconnected_from(const position& from, const std::vector<position>& places, double range_m);

/// The same, with any of several places.
[[nodiscard]] std::vector<std::size_t> disconnected_from_any(const std::vector<position>& from,
                                                             const std::vector<position>& places,
                                                             double range_m);

/// How many steps of at most `range_m` lead from the place of index `from` to each; 0 also where
/// none do. @param range_m > 0
[[nodiscard]] std::vector<unsigned> hops_from(const std::vector<position>& places, std::size_t from,
                                              double range_m);

} // namespace rubicon::config
