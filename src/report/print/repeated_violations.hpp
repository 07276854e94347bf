// Violations as people read them: equal ones in one line.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "report/figures.hpp"
#include "report/report.hpp"

namespace rubicon::report {

/// Equal violations at several times.
struct repeated_violation {
  violation first;
  instant last;
  std::size_t count = 1;
};

/// In the order of their first ones.
[[nodiscard]] std::vector<repeated_violation> repeated(const std::vector<violation>& all);

/// `its detail; 48 times, the last at 0:12.000`.
[[nodiscard]] std::string detail_of(const repeated_violation& x);

} // namespace rubicon::report
