// What the report of a run that was attacked tells.
#pragma once

#include <string>

namespace rubicon::hostile {

/// Prints one line: the counts other than 0 of what was given up, `lost.CAUSE`, of links that were
/// closed, `links_closed.CAUSE`, and of what limits have refused, `limits.CAUSE`, over all peers.
/// @param file the JSON object of `rubicon run --json` (docs/report.md)
/// @param attack its name, or `all`
/// @param table as the last cell of a Markdown table's row
/// @returns whether the report is complete, all peers live, nothing that must hold was violated,
/// and the attack is told
[[nodiscard]] bool tell_report(const std::string& file, const std::string& attack, bool table);

} // namespace rubicon::hostile
