// What the parts of a summary have in common.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "config/plan/ecology.hpp"

namespace rubicon::config {

/// The cells of a line.
using row = std::vector<std::string>;

[[nodiscard]] std::string joined(const std::vector<std::string>& words,
                                 std::string_view between = ", ");

/// `1 mote`, `2 motes`
[[nodiscard]] std::string counted(std::size_t count, const std::string& what);

/// `7 %` of 0.07
[[nodiscard]] std::string percent(double ratio);

[[nodiscard]] std::string island_names(const ecology_description& x,
                                       const std::vector<island_id>& ids);

/// When each fault happens, what, and to whom.
[[nodiscard]] std::vector<row> fault_rows(const ecology_description& x);

/// Such a row in one text, without when.
[[nodiscard]] std::string fault_text(const row& x);

} // namespace rubicon::config
