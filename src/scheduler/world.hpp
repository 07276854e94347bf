// A CAF actor system under one of our clocks, with everything that belongs to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <caf/actor_system.hpp>
#include <caf/actor_system_config.hpp>

#include "core/time.hpp"
#include "scheduler/coordinator.hpp"
#include "scheduler/messages/spawn.hpp"
#include "scheduler/trace.hpp"

namespace rubicon::io {
class loop;
}

namespace rubicon::scheduler {

struct world_options {
  time_mode mode = time_mode::virtual_time;

  /// Ecology seconds per real second. 0: as fast as possible in virtual time, 1 in wall time. In
  /// virtual time it paces the run and changes the order of nothing.
  double speed = 0;

  /// Where sockets and signals live; the world makes its own if nullptr. A loop from outside must
  /// outlive the world, and callbacks pending in it must not own actor handles.
  io::loop* loop = nullptr;

  /// That may execute events of several processes at the same time. Wall time has one.
  unsigned threads = 1;

  /// In virtual time events happen in the order of their time, one after the other.
  bool in_order = false;

  bool trace = true; ///< false: actors are placed, but nothing is folded

  /// Adapts the configuration before the actor system starts: other modules, message types.
  std::function<void(caf::actor_system_config&)> configure = {};
};

/// Owns an actor system, its coordinator, its trace and, unless given, its loop. Belongs to the
/// thread that makes it; only request_stop() may be called from others.
class world {
public:
  explicit world(world_options options = {});
  ~world(); ///< shutdown()
  world(const world&) = delete;
  world& operator=(const world&) = delete;

  [[nodiscard]] caf::actor_system& system() { return *system_; }
  [[nodiscard]] coordinator& scheduler() { return *coordinator_; }
  [[nodiscard]] io::loop& loop() { return *loop_; }

  /// Ecology time. In virtual time the time of the current event. In wall time it follows the real
  /// clock from the start of the first run, but never beyond the end of the current or last run; a
  /// run that starts later goes on at the real clock's time.
  [[nodiscard]] instant now() const { return coordinator_->now(); }

  /// Executes every event up to and at `end`; see coordinator::run_until.
  stop_cause run_until(instant end) { return coordinator_->run_until(end); }
  stop_cause run_for(duration length) { return run_until(now() + length); }

  /// Executes what is ready without letting time pass, for the last messages of a run.
  /// @returns false if actors still keep each other busy after `turns_max` turns
  bool drain(std::size_t turns_max = 1'000'000) { return coordinator_->drain(turns_max); }

  /// Ends the current run, or the next if there is none. From any thread.
  void request_stop() { coordinator_->request_stop(); }

  /// Ends what is alive and takes the actor system down: pending timeouts and delayed messages are
  /// dropped, then actors end as by exit_reason::kill and their states are destroyed. Actors that
  /// are to leave in good order must have been asked to, and drained or run, before. Afterwards
  /// only trace() and stats() may be used; handles may still exist, but nothing may be sent to
  /// them. Harmless if repeated.
  void shutdown();

  [[nodiscard]] trace_recorder& trace() { return trace_; }
  [[nodiscard]] const trace_recorder& trace() const { return trace_; }
  [[nodiscard]] statistics stats() const;

  /// Spawns an actor of the supervisor's process at `path`.
  template <class Fun, class... Args>
  auto spawn(std::string path, Fun fun, Args&&... args) {
    auto made = make_at(*system_, coordinator_->supervisor(), std::move(path), std::move(fun),
                        std::forward<Args>(args)...);
    made.get().launch(nullptr, false, false);
    return made;
  }

private:
  trace_recorder trace_;
  std::unique_ptr<io::loop> own_loop_;
  io::loop* loop_;
  std::unique_ptr<coordinator_config> config_;
  std::unique_ptr<caf::actor_system> system_;
  coordinator* coordinator_ = nullptr;
  statistics last_stats_;
};

} // namespace rubicon::scheduler
