// From the description of an ecology to its actors.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "actors/messages/common.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/supervision/ecology.hpp"
#include "scheduler/messages/spawn.hpp"

namespace rubicon {

using ecology_pointer = scheduler::actor_pointer<ecology_state, root_actor>;

/// Spawns everything that the description in the ecology's state places here, in an order that
/// depends on the description alone.
void assemble(ecology_pointer self);

/// Something is started that has been `starts` - 1 times before. A later process is to give
/// everything a number that nothing had.
void note_starts(ecology_pointer self, std::uint32_t starts);

/// Spawns the kernel of a peer, for the first time or again.
/// @param path `peis_peer/NAME`, or another one for a second kernel of the same peer
void spawn_kernel(ecology_pointer self, supervised_peer& peer, const std::string& path);

/// Spawns the programs of a peer: its apps, or its gateway. @pre its kernel runs
void spawn_programs(ecology_pointer self, supervised_peer& peer);

/// Keeps a child that is monitored: by its name, and as one that has something to report.
template <class Handle>
void adopt(ecology_pointer self, std::string path, const Handle& handle) {
  ++self->state.report.actors.spawned;
  self->state.names.emplace(handle.address(), std::move(path));
  self->state.reporters.emplace_back(handle.address(),
                                     [self, handle](status_request x) { self->send(handle, x); });
}

/// Spawns a monitored child that reports to the ecology.
template <class Fun, class... Args>
auto spawn_child(scheduler::process& where, ecology_pointer self, std::string path, Fun fun,
                 Args&&... args) {
  auto handle = scheduler::spawn_in<scheduler::monitored>(where, self, path, fun,
                                                          std::forward<Args>(args)...);
  adopt(self, std::move(path), handle);
  return handle;
}

/// serial::slowness() of the slowest of an island's lines.
[[nodiscard]] std::int64_t line_slowness(const config::island_description& island);

/// Spawns a mote's program in an actor of its own, for the first time or again after a failure.
void spawn_program(ecology_pointer self, const supervised_mote& mote, supervised_program& x);

/// Spawns a sink, for the first time or again after a failure.
void spawn_sink(ecology_pointer self, supervised_sink& x);

/// Spawns a mote, for the first time or again after a failure.
void spawn_mote(ecology_pointer self, supervised_mote& mote);

} // namespace rubicon
