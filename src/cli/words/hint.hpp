// What to do about a failure of the operating system.
#pragma once

#include <string>

namespace rubicon::cli {

/// `x`, followed by a cure if it ends with a reason of the operating system that has a usual one.
[[nodiscard]] std::string with_hint(const std::string& x);

} // namespace rubicon::cli
