// What the root supervisor changes of an ecology while it runs (ACT-10).
#pragma once

#include <string>
#include <vector>

#include "actors/supervision/assembly.hpp"

namespace rubicon {

/// Applies changes, which are planned as faults are. Each is in the event log.
struct change_applier {
  ecology_pointer self;

  void operator()(const config::debug_change& x) const;
  void operator()(const config::program_change& x) const;
  void operator()(const config::link_change& x) const;
  void operator()(const proxy::class_change& x) const;
  void operator()(const config::network_keys_change& x) const;
};

/// The debug log has messages of these only from now on (NFR-02). A pattern that means nobody is
/// told and counted, and changes nothing.
/// @param who wants it: an actor's path
void select_debug(ecology_pointer self, const std::string& who, std::vector<std::string> patterns);

} // namespace rubicon
