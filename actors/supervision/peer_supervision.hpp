// What the root supervisor does with peers: ends them, starts them again, and disturbs their
// network, as the fault plan wants it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "actors/messages/supervision.hpp"
#include "actors/supervision/assembly.hpp"

namespace rubicon {

/// Applies the faults of peers and of their network.
struct peer_fault_applier {
  ecology_pointer self;

  void operator()(const config::kill_fault& x) const;
  void operator()(const config::power_off_fault& x) const;
  void operator()(const config::pause_fault& x) const;
  void operator()(const config::partition_fault& x) const;
  void operator()(const config::link_loss_fault& x) const;
  void operator()(const config::duplicate_id_fault& x) const;
  void operator()(const config::clock_step_fault& x) const;
  void operator()(const config::move_fault& x) const;
};

/// Starts a peer that has ended, or has never run.
void restart(ecology_pointer self, supervised_peer& peer);

/// An init starts or stops a peer of its host.
void start_component_peer(ecology_pointer self, const start_component& x);
void stop_component_peer(ecology_pointer self, const stop_component& x);

/// The run is over: all leave, and inits stop their components first.
void end_peers(ecology_pointer self);

/// An init's actor may have failed: what it has started ends too.
void on_init_down(ecology_pointer self, const caf::actor_addr& init);

/// A kernel's actor has ended by itself: its programs end with it, as a process does.
/// @returns whether it was a kernel
bool on_kernel_down(ecology_pointer self, const caf::actor_addr& kernel);

/// A duplicate's time is over.
void end_duplicate_peer(ecology_pointer self, const std::string& name);

/// The peer with that id, or for any_peer one that is drawn; nullptr if it does not run.
[[nodiscard]] supervised_peer* find_running(ecology_pointer self, peer_id id);

} // namespace rubicon
