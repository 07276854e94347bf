// Finished reports for tests: one in which every part holds something, and one of a large run.
#pragma once

#include "report/report.hpp"

namespace rubicon::test {

/// Two islands, five motes of which one ran out of battery, two peers, three proxies, a flow to a
/// sink and a broadcast; all run_counters balance and nothing is violated.
[[nodiscard]] report::run_report sample_report();

/// The same with a third island, whose only mote measures and does not join.
[[nodiscard]] report::run_report lab_report();

/// Fifty islands of twenty motes, and forty flows.
[[nodiscard]] report::run_report large_report();

} // namespace rubicon::test
