// What a seed has decided of its file, as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "config/run/variation.hpp"

namespace rubicon::report {

[[nodiscard]] inline nlohmann::ordered_json variation_json(const config::variation& x) {
  return {{"drawn", x.drawn}, {"left_out", x.left_out}};
}

} // namespace rubicon::report
