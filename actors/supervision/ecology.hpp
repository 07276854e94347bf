// The root supervisor: spawns what a description says, keeps it running, applies its fault plan,
// and collects the report.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "actors/base/frame_observer.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "apps/traffic.hpp"
#include "config/plan/ecology.hpp"
#include "core/numbers/random.hpp"
#include "io/loop.hpp"
#include "mote/nonvolatile.hpp"
#include "report/expect/expectations.hpp"
#include "report/fault_plan.hpp"
#include "report/invariants.hpp"
#include "report/report.hpp"
#include "report/run_counters.hpp"
#include "report/time_watch.hpp"
#include "transport/messenger.hpp"

namespace rubicon {

namespace bridge {
class broker_site;
} // namespace bridge

namespace rfid {
struct tag;
} // namespace rfid

namespace mote {
struct node_tables;
} // namespace mote

// What motes, programs and sinks are made of: their own headers are large.
struct mote_arguments;
struct program_arguments;
struct sink_arguments;

using report_receiver = std::function<void(report::run_report&)>;

/// A program of a mote, in an actor of its own, as its supervisor knows it.
struct supervised_program {
  std::shared_ptr<const program_arguments> arguments;
  std::string path;
  std::uint32_t incarnation = 0; ///< how often it was started before
  program_actor handle;          ///< nullptr while it is out of order
};

/// A mote as its supervisor knows it.
struct supervised_mote {
  std::shared_ptr<const mote_arguments> arguments;
  mote::nonvolatile store; ///< its flash
  mote_actor handle;
  std::string type;
  bool joined = false; ///< ever
  bool flat = false;
  bool in_transit = false; ///< to another island, with a battery of which
  double used_mah = 0;     ///< so much is used
  std::optional<std::pair<bool, std::uint32_t>> last_listing; ///< and its incarnation
  std::string left_cause;
  instant changed; ///< when it was last started, flat, listed or unlisted
  std::vector<supervised_program> programs;
};

/// A second mote with the address of another, from the fault plan.
struct supervised_double {
  mote_actor handle;
  mote::nonvolatile store; ///< its flash
};

/// A sink as its supervisor knows it.
struct supervised_sink {
  std::shared_ptr<const sink_arguments> arguments;
  std::string path;
  mote::nonvolatile store; ///< its flash
  sink_actor handle;       ///< nullptr while it is out of order
  instant changed;         ///< when it was last started or ended, or its clock was set
};

/// The end of a mote or sink that the fault plan has asked for.
struct planned_end {
  std::string path;
  duration length{}; ///< until it starts again
  std::uint32_t fault = 0;
};

/// A mote that the fault plan has carried to another island.
struct carried_mote {
  mote_address to;         ///< its address from then on
  std::string former_name; ///< as the file has it
};

/// Where a fault of the plan has a radio of its own.
struct fault_radio {
  air_actor air;
  radio::radio_index radio;
};

/// A peer, or an island's gateway, as its supervisor knows it.
struct supervised_peer {
  peer_id id;
  std::string name;
  std::optional<island_id> island; ///< whose gateway it is,
  std::size_t line = 0;            ///< at which of the sink's serial lines
  peis_peer_actor handle;          ///< its kernel; nullptr while it does not run
  std::vector<caf::strong_actor_ptr> programs;
  init_actor init;                           ///< among its programs; nullptr: none
  std::vector<proxy_manager_actor> managers; ///< among them too
  std::optional<peer_id> component_of;       ///< whose init starts and stops it
  std::uint64_t life = 0;                    ///< as that init calls it
  bool begun = false;                        ///< it has ever run
  std::uint64_t station = 0;                 ///< of the kernel in the simulated network
  std::string machine;                       ///< host name of the kernel
  std::uint32_t incarnation = 0;
  bool powered = true;
  instant changed;                   ///< when it was last started or ended
  std::optional<instant> away_since; ///< when its newest life but this one ended
  /// The simulated broker of its MQTT bridge, over all lives; nullptr: none.
  std::shared_ptr<bridge::broker_site> broker;
};

/// What the process knows of itself.
struct process_facts {
  std::string machine;                    ///< its name
  io::loop* loop = nullptr;               ///< of the real network; nullptr: there is none
  std::uint32_t number = 1;               ///< in-process addresses of other processes are not ours
  duration clock_offset = 1'000'000'000s; ///< network time minus ecology time
  /// Called when, after end_run, no init runs any more; may be empty.
  std::function<void()> on_inits_ended = {};
  /// Called when the run is to end before its time, and why; may be empty.
  std::function<void(const std::string& why)> on_end_wanted = {};
  /// Notified of each mote, `kitchen/climate-7`, when its battery is flat; may be empty.
  std::function<void(const std::string& mote)> on_flat = {};
  /// Notified of what goes wrong after the report was handed out; may be empty.
  std::function<void(report::violation)> on_late_violation = {};
  /// Who judges the run; nullptr: none does. Outlives the ecology.
  report::expectations* judge = nullptr;
  /// Notified of each event as it is noted; may be empty.
  std::function<void(const report::logged_event&)> on_event = {};
  /// Notified of what a report is settled from, before each; may be empty.
  std::function<void(const report::run_counters&)> on_counters = {};
  bool writes_debug_log = false;
  std::uint32_t starts = 0; ///< so often everything may have been started by earlier processes
  /// Called when something has been started more often than anything before; may be empty.
  std::function<void(std::uint32_t starts)> on_starts = {};
};

/// A time as a mote knows it.
struct known_time {
  std::chrono::microseconds ahead; ///< of real time
  std::chrono::microseconds doubt; ///< how far off it may be, as the mote says
};

/// What the motes of an island and its sink know at the end.
struct island_clocks {
  std::optional<std::chrono::microseconds>
      sink_ahead; ///< nothing: it does not know the time either
  std::vector<known_time> motes;
  std::vector<known_time> network;      ///< as the motes and the sink know the time of peers,
  std::optional<duration> clock_offset; ///< and as their gateway's kernel does
};

/// Answers to one question for samples: motes may answer before their sink has.
struct clock_samples {
  std::uint64_t number = 0;
  std::optional<std::int64_t> sink_ahead_us;
  std::vector<std::pair<mote_address, std::int64_t>> waiting;
};

/// What the answers to collect_report are put together from.
struct collected_answers {
  std::map<peer_id, report::peer_view> peer_views; ///< as the peers say at the end
  std::map<island_id, island_clocks> clocks;
  report::run_report report;
  report::run_counters counters;
  std::map<mote_address, std::vector<network::channel_id>> channel_tables; ///< of the living
  std::map<std::pair<mote_address, mote_address>, traffic::part> flows;    ///< by origin and target
  std::map<island_id, std::vector<mote_id>> listed; ///< as the gateways say at the end
  bool delivered = false;                           ///< deliver_report has come
};

/// What the description says, and what all that is spawned has in common.
struct shared_parts {
  config::ecology_description description;
  /// From the description as it was before its motes were taken out.
  transport::answer_slacks slacks;
  std::map<island_id, apps::traffic> traffic; ///< of the programs on all motes of an island
  /// Of motes without programs of their own, which share them.
  std::map<island_id, std::shared_ptr<const mote::node_tables>> tables;
  /// Of the world; nullptr until a reader needs them.
  std::shared_ptr<const std::vector<rfid::tag>> tags;
  scheduler::process* pcs = nullptr; ///< of all peers, and of the networks between them
  std::map<island_id, scheduler::process*> processes;
};

/// Who is notified of what the run does.
struct run_observers {
  report_receiver on_report;
  process_facts process;
  frame_observer observe_frames;      ///< may be empty
  message_ledger* messages = nullptr; ///< the account of all messages; outlives everybody
  report::time_watch watch;           ///< notified of motes by all that look at them
};

/// What was spawned of islands.
struct spawned_islands {
  std::map<mote_address, supervised_mote> motes;
  std::map<island_id, supervised_sink> sinks; ///< of islands with the full stack
  std::map<island_id, air_actor> airs;
  std::map<std::pair<island_id, std::size_t>, serial_line_actor> lines; ///< of sinks, numbered
  std::map<mote_address, backbone_actor> backbones;                     ///< of further sinks
  std::map<island_id, serial_line_actor> real_lines; ///< to real motes beside simulated ones
};

/// What was spawned of peers.
struct spawned_peers {
  peis_lan_actor lan;
  peis_bluetooth_actor bluetooth;                    ///< nullptr: no peer has an adapter
  std::map<std::string, supervised_peer> peers;      ///< by name
  std::map<std::string, supervised_peer> duplicates; ///< from the fault plan
  std::uint64_t stations = 0;                        ///< so far
};

/// Who is asked how it is, and who has ended.
struct monitored_actors {
  /// Everything spawned here that answers a status_request with messages to the ecology.
  std::vector<std::pair<caf::actor_addr, std::function<void(status_request)>>> reporters;
  std::map<caf::actor_addr, std::string> names; ///< of monitored actors other than motes
  std::uint64_t samples = 0;                    ///< asked for so far
  std::map<island_id, clock_samples> sampled;
  std::uint32_t most_starts = 0; ///< of all motes, sinks and peers
};

/// The fault plan, and what it has changed.
struct plan_progress {
  std::vector<report::planned_fault> plan;
  std::size_t next_fault = 0;     ///< in `plan`
  std::size_t planned_faults = 0; ///< of the description's; later ones are applied on request
  std::map<std::uint32_t, fault_radio> noises; ///< by the fault's index in the description
  /// What a mote is after a fault of the plan, by the fault's index.
  std::map<std::uint32_t, std::shared_ptr<const mote_arguments>> successors;
  std::map<std::uint32_t, supervised_double> doubles; ///< by the fault's index
  std::map<mote_address, carried_mote> moved;         ///< by the address that each had before
  std::map<mote_address, instant> gone;          ///< since when they are no more where they were
  std::vector<planned_end> planned_ends;         ///< that are still to come
  std::uint64_t lan_faults = 0;                  ///< so far
  random_stream rng;                             ///< draws whom a fault hits
  std::map<island_id, instant> last_clock_fault; ///< clocks set, and sinks started again
  instant last_lan_fault;                        ///< when the simulated network last changed
  instant last_outside_change;                   ///< of a link to another process
};

struct ecology_state : shared_parts,
                       run_observers,
                       spawned_islands,
                       spawned_peers,
                       monitored_actors,
                       plan_progress,
                       collected_answers {
  bool ending = false; ///< end_run has come
};

/// @param on_report called once, from the actor, when deliver_report comes
/// @param observe_frames notified of every frame on the air; may be empty
root_actor::behavior_type ecology(scheduler::actor_pointer<ecology_state, root_actor> self,
                                  config::ecology_description description,
                                  report_receiver on_report, frame_observer observe_frames,
                                  process_facts process);

} // namespace rubicon
