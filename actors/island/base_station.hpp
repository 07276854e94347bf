// A sink that runs TinyOS's BaseStation: it forwards frames and packets, and has no members.
#pragma once

#include "actors/island/sink.hpp"

namespace rubicon {

/// In a sink's place: the same interface, lines and faults. Of its store it needs how often it has
/// started alone. @pre the arguments have one line
sink_actor::behavior_type base_station(scheduler::actor_pointer<sink_state, sink_actor> self,
                                       sink_arguments arguments, mote::nonvolatile store);

} // namespace rubicon
