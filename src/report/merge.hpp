// The report of an ecology from those of its parts, each of which ran in processes of its own.
#pragma once

#include <string>
#include <vector>

#include "config/plan/ecology.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "report/report.hpp"
#include "report/run_counters.hpp"

namespace rubicon::report {

/// What a part has reported of one of its lives, at the end or so far.
struct part_report {
  run_report report;
  unsettled_counters counters;
};
RUBICON_FIELDS(part_report, report, counters);

/// A process of a part.
struct part_life {
  duration elapsed{};    ///< of the whole when it began
  part_report newest;    ///< without a name if it has sent none
  bool is_final = false; ///< it has come to its end, and nothing follows
  duration ended{};      ///< of the whole when it ended; 0: it runs, or nobody has seen its end
};

/// The processes of a host's part, the newest last.
struct host_report {
  std::string host;
  std::vector<part_life> lives;
};

/// How often a part's process leaves a report: what it has counted since is lost when it is killed.
inline constexpr duration part_report_every = 5s;

/// Times are those of the whole. What a process has counted after its last report, because it was
/// killed, is not known: the event log says so. If that is more than can be lost between two
/// reports, the whole is not complete.
/// @param description of the whole
[[nodiscard]] run_report merged(const config::ecology_description& description,
                                const std::vector<host_report>& parts);

} // namespace rubicon::report
