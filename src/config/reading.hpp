// What the readers of one file share.
#pragma once

#include <memory>

#include "config/plan/directory.hpp"
#include "config/plan/places.hpp"
#include "config/plan/quantities.hpp"
#include "config/toml/problem.hpp"
#include "core/time.hpp"
#include "proxy/rules/rules_config.hpp"

namespace rubicon::config {

class trace_files;
struct named_files;

struct reading {
  complaints problems;
  /// Nothing is read: every reader walks through all the tables it might meet, and they are
  /// described.
  bool walks = false;
  trace_files* traces = nullptr;      ///< not set where other files are not read
  const named_files* files = nullptr; ///< the same
  /// Empty before the names of the file are read; never nullptr.
  std::shared_ptr<const directory> names = nobody_yet();
  config::quantities quantities;
  file_places seen;
  duration end = duration::max(); ///< of the run, as far as the file says it well
  /// Of the clock by which `at` of rules counts.
  std::vector<proxy::clock_change> clock_changes{};
};

} // namespace rubicon::config
