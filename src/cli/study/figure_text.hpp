// Figures of studies as people read them.
#pragma once

#include <string>

#include "study/statistics.hpp"

namespace rubicon::cli {

/// Five digits that count.
[[nodiscard]] std::string number_text(double x);

/// `1.2 to 1.4`
[[nodiscard]] std::string interval_text(const study::interval& x);
/// The same of its mean; empty without an interval.
[[nodiscard]] std::string interval_text(const study::estimate& x);

/// `95 %`, with at most two decimals
[[nodiscard]] std::string percent_text(double ratio);

} // namespace rubicon::cli
