// What `rubicon check --explain` prints of keys.
#pragma once

#include <string>
#include <string_view>

#include "config/toml/schema.hpp"

namespace rubicon::cli {

struct key_explanation {
  bool is_found = false;
  std::string text; ///< of the keys, or why there are none
};

/// Explains all keys that are meant: equal ones once, with all their places; a line for each if
/// they are many.
[[nodiscard]] key_explanation explain_key(const config::table_description& file,
                                          std::string_view wanted);

} // namespace rubicon::cli
