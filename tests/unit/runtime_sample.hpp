// Finished reports for tests: one in which every part holds something, and one of a large run.
#pragma once

#include "runtime/report.hpp"

namespace rubicon::test {

/// Two islands, five motes of which one ran out of battery, two peers, three proxies; all books
/// balance and nothing is violated.
[[nodiscard]] runtime::report sample_report();

/// Fifty islands of twenty motes.
[[nodiscard]] runtime::report large_report();

} // namespace rubicon::test
