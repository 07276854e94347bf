// A reader of tags on a robot or a PC: the interface of things without a radio (PXY-02).
#pragma once

#include <memory>

#include "actors/messages.hpp"
#include "actors/timer.hpp"
#include "rfid/reader.hpp"

namespace rubicon {

struct rfid_reader_state {
  rfid_reader_state() = default;

  rfid::reader core;
  peis_peer_actor peer;
  timer wake;
};

/// Keeps the interface's tuples in the peer's own space.
timed_peer_app_actor::behavior_type
rfid_reader(scheduler::traced_pointer<rfid_reader_state, timed_peer_app_actor> self,
            rfid::reader core, peis_peer_actor peer);

} // namespace rubicon
