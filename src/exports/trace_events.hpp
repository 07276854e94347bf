// A record as trace events, the JSON that Perfetto (https://ui.perfetto.dev) and the tracing page
// of Chrome show.
#pragma once

#include "explain/traces.hpp"
#include "exports/octets_out.hpp"

namespace rubicon::exports {

/// Each mote, sink, gateway, peer and proxy is a process, whose threads are its programs and the
/// media that it sends on; a further thread of a medium has what overlaps with the first. A step
/// of a message or value is a slice, its attempts are slices in it, and a flow binds all steps of
/// one message or value.
void write_trace_events(const explain::traces& all, const octets_out& out);

} // namespace rubicon::exports
