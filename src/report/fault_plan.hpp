// When each fault of a description happens (ACT-04).
#pragma once

#include <cstdint>
#include <vector>

#include "config/plan/ecology.hpp"
#include "core/time.hpp"

namespace rubicon::report {

/// One time at which a fault happens.
struct planned_fault {
  duration at{};
  std::uint32_t index = 0; ///< in ecology_description::faults

  friend bool operator==(const planned_fault&, const planned_fault&) = default;
};

/// Every time of one fault up to the end of the run, ascending.
/// @param index of the fault; random moments depend on it and the seed
[[nodiscard]] std::vector<duration> times_of(const config::fault_description& x,
                                             std::uint32_t index, std::uint64_t seed,
                                             duration length);

/// Every time of every fault up to the end of the run, ascending; equal times in the order of the
/// description. Random moments depend on the seed and the fault's place among the others.
[[nodiscard]] std::vector<planned_fault> plan_faults(const config::ecology_description& x);

} // namespace rubicon::report
