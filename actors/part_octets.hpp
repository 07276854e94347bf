// What a part tells, as octets that another process of the same program reads.
#pragma once

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "report/merge.hpp"

namespace rubicon {

[[nodiscard]] bytes octets_of(const report::part_report& x);

/// bad_value for what octets_of() of this very program has not made.
[[nodiscard]] result<report::part_report> part_report_of(byte_view octets);

} // namespace rubicon
