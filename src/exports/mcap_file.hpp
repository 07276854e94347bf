// A record as a file of MCAP, which Foxglove and Rerun show.
#pragma once

#include "explain/traces.hpp"
#include "exports/octets_out.hpp"

namespace rubicon::exports {

/// In order of time: how messages ended, tuples, events, and of each sample places and links of
/// motes. Times are ecology time.
void write_mcap(const explain::traces& all, const octets_out& out);

} // namespace rubicon::exports
