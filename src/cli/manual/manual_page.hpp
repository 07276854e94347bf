// Pages of the manual, of the descriptions of commands and keys.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/words/command_description.hpp"
#include "config/toml/schema.hpp"

namespace rubicon::cli {

/// What all pages have in common.
struct manual_edition {
  std::string date;    ///< YYYY-MM-DD; no other characters
  std::string version; ///< `0.1.0`
};

struct manual_page {
  std::string file; ///< `rubicon-run.1`
  std::string text; ///< for man(7)
};

/// rubicon(1), one for each command, and rubicon.toml(5).
[[nodiscard]] std::vector<manual_page> manual_pages(const command_description& all,
                                                    const config::table_description& file,
                                                    const manual_edition& edition);

} // namespace rubicon::cli
