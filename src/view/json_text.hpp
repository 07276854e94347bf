// For files of this room only: JSON as the page is sent it.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace rubicon::view {

/// Octets that are no UTF-8 are replaced.
[[nodiscard]] inline std::string text_of(const nlohmann::ordered_json& x) {
  return x.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

} // namespace rubicon::view
