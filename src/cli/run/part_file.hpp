// The file in which a part's process leaves its newest report for the deployment that has started
// it.
#pragma once

#include <optional>
#include <string>

#include "report/merge.hpp"

namespace rubicon::cli {

/// Replaces the file at once: its reader finds this report or the one before.
/// @returns empty, or why it is not written
[[nodiscard]] std::string write_part_file(const std::string& path, const report::part_report& x,
                                          bool is_final);

struct part_file {
  report::part_report newest;
  bool is_final = false;
};

/// @returns nothing if there is none, or one that this program has not written
[[nodiscard]] std::optional<part_file> read_part_file(const std::string& path);

} // namespace rubicon::cli
