// When each fault of a description happens (ACT-04).
#pragma once

#include <cstdint>
#include <vector>

#include "config/ecology.hpp"
#include "core/time.hpp"

namespace rubicon::report {

/// One time at which a fault happens.
struct planned_fault {
  duration at{};
  std::uint32_t index = 0; ///< in ecology_description::faults

  friend bool operator==(const planned_fault&, const planned_fault&) = default;
};

/// Every time of every fault up to the end of the run, ascending; equal times in the order of the
/// description. Random moments depend on the seed and the fault's place among the others.
[[nodiscard]] std::vector<planned_fault> plan_faults(const config::ecology_description& x);

} // namespace rubicon::report
