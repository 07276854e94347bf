// Files that gzip has compressed.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "imports/plan.hpp"

namespace rubicon::imports {

/// Whether it begins as such a file.
[[nodiscard]] bool is_gzip(std::string_view octets);

/// The content of a whole file, of all its members one after the other. What has more than
/// file_octets_max is a problem, and no more than that is held meanwhile.
[[nodiscard]] std::variant<std::string, import_problem> gunzip(std::string_view octets);

} // namespace rubicon::imports
