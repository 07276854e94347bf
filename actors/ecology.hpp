// The root supervisor: spawns what a description says, keeps it running, applies its fault plan,
// and collects the report.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "actors/air.hpp"
#include "actors/messages.hpp"
#include "actors/mote.hpp"
#include "config/ecology.hpp"
#include "runtime/invariants.hpp"
#include "runtime/report.hpp"

namespace rubicon {

using report_receiver = std::function<void(runtime::report)>;

/// A mote as its supervisor knows it.
struct supervised_mote {
  std::shared_ptr<const mote_arguments> arguments;
  std::uint32_t incarnation = 0; ///< how often it was started before
  mote_actor handle;
  std::string type;
  bool joined = false; ///< ever
  bool flat = false;
  std::string left_cause;
  instant changed; ///< when it was last started, flat, listed or unlisted
};

struct ecology_state {
  config::ecology_description description;
  report_receiver on_report;
  frame_observer observe_frames; ///< may be empty
  std::map<mote_address, supervised_mote> motes;
  std::map<island_id, serial_line_actor> lines;
  std::map<std::string, std::pair<peer_id, peis_peer_actor>> peers; ///< by name
  /// Everything spawned here that answers a status_request with messages to the ecology.
  std::vector<std::function<void(status_request)>> reporters;
  std::map<caf::actor_addr, std::string> names; ///< of monitored actors other than motes
  runtime::report report;
  std::map<std::pair<mote_address, mote_address>, flow::part> flows; ///< by origin and target
  std::map<island_id, std::vector<mote_id>> listed; ///< as the gateways say at the end
  std::vector<std::string> crashes_requested;
  std::uint64_t next_link = 1;
};

/// @param on_report called once, from the actor, when deliver_report comes
/// @param observe_frames told of every frame on the air; may be empty
root_actor::behavior_type ecology(scheduler::traced_pointer<ecology_state, root_actor> self,
                                  config::ecology_description description,
                                  report_receiver on_report, frame_observer observe_frames);

} // namespace rubicon
