// A file that is read again while the ecology runs that it describes (ACT-10).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/load.hpp"
#include "config/plan/change.hpp"
#include "config/plan/ecology.hpp"
#include "config/toml/document.hpp"
#include "config/toml/problem.hpp"

namespace rubicon::config {

/// What follows from a file that now says something else.
struct reloaded {
  std::vector<change> changes;         ///< from now on
  std::vector<fault_description> plan; ///< faults and changes that join the plan
  std::vector<problem> refused;        ///< what differs and cannot follow, in order of place; or
                                       ///< what is wrong with the file: then there is nothing else
};

/// A file, as it was when the run began and as it was read last.
class followed_file {
public:
  /// @param toml what the run began with, @pre which is free of problems
  followed_file(std::string_view toml, std::string name, overrides instead, extensions known);

  /// @param now what was to happen before is too late
  [[nodiscard]] reloaded read(std::string_view toml, duration now);

private:
  std::string name_;
  overrides instead_;
  extensions known_;
  node first_;
  node newest_;
  ecology_description described_; ///< by the newest
};

} // namespace rubicon::config
