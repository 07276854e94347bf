// Descriptions as octets, which this very program reads again, in another process or later.
#pragma once

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "deploy/bundle.hpp"
#include "report/merge.hpp"

namespace rubicon::control {

[[nodiscard]] bytes octets_of(const report::part_report& x);
[[nodiscard]] bytes octets_of(const deploy::bundle& x);

/// bad_value for what octets_of() has not made.
[[nodiscard]] result<report::part_report> part_report_of(byte_view octets);
[[nodiscard]] result<deploy::bundle> bundle_of(byte_view octets);

} // namespace rubicon::control
