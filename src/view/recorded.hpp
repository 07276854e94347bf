// A record as a timeline.
#pragma once

#include <memory>

#include "explain/traces.hpp"
#include "view/timeline.hpp"

namespace rubicon::view {

/// Adds what a record contains: samples, tuples, events, planned faults and messages.
void fill(timeline& out, std::shared_ptr<const explain::traces> all);

} // namespace rubicon::view
