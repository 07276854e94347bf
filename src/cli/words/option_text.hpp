// Values as options of a command line take them.
#pragma once

#include <string>
#include <utility>

#include "core/time.hpp"

namespace rubicon::cli {

/// A length: `90s`, `1h`.
[[nodiscard]] inline std::string option_text(duration x) {
  for (const auto& [unit, name] : {std::pair(duration(1h), "h"), std::pair(duration(1min), "min"),
                                   std::pair(duration(1s), "s")})
    if (x % unit == 0s)
      return std::to_string(x / unit) + name;
  return std::to_string(x / 1ms) + "ms";
}

} // namespace rubicon::cli
