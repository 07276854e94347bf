// The scheduler module for CAF: one thread, virtual or wall clock (design.md section 5, GEN-07).
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <caf/actor_control_block.hpp>
#include <caf/actor_system_config.hpp>
#include <caf/execution_unit.hpp>
#include <caf/resumable.hpp>
#include <caf/scheduler/abstract_coordinator.hpp>

#include "core/time.hpp"
#include "io/spare_memory.hpp"
#include "scheduler/outside.hpp"
#include "scheduler/ready_queue.hpp"
#include "scheduler/run_clock.hpp"

namespace rubicon::io {
class loop;
}

namespace rubicon::scheduler {

class trace_recorder;

/// Why a run came back.
enum class stop_cause : std::uint8_t {
  reached_end, ///< every event up to and at the end was executed; now() is the end
  requested,   ///< request_stop() was called
};

/// What was done so far.
struct statistics {
  std::uint64_t resumes = 0;  ///< turns that actors were given
  std::uint64_t timeouts = 0; ///< timeouts and delayed messages that fired
  std::uint64_t waiting = 0;  ///< those that have not, now
};

struct coordinator_options {
  time_mode mode = time_mode::virtual_time;
  double speed = 0;         ///< as in world_options
  io::loop* loop = nullptr; ///< must outlive the actor system, or be taken back by detach_io()
};

/// The configuration that installs the coordinator and carries its options.
struct coordinator_config : caf::actor_system_config {
  explicit coordinator_config(coordinator_options x);

  coordinator_options options;
};

/// Runs actors and timeouts on one thread, the one that made the actor system: ready actors in
/// first in, first out order; when none is ready, the timeouts of the next time at which there are
/// any, in the order they were set. In virtual time the clock jumps there; in wall time the loop
/// waits, and sockets share the thread.
///
/// Other threads may enqueue, spawn, set and cancel timeouts and ask for a stop; what they ask is
/// taken over by the running thread in the order it was asked. In virtual time such a run is not
/// repeatable.
class coordinator final : public caf::scheduler::abstract_coordinator {
public:
  explicit coordinator(caf::actor_system& system);
  ~coordinator() override;

  /// What actor_system_config::load asks for.
  static caf::actor_system::module* make(caf::actor_system& system, caf::detail::type_list<>);

  /// The coordinator of a system; nullptr if another scheduler is installed.
  [[nodiscard]] static coordinator* of(caf::actor_system& system);

  /// Executes every event at or before `end`, ending the run early if a stop is requested: looked
  /// at before every turn. A turn is at most 50 messages of one actor. The loop is polled at least
  /// every 16 turns if 10 ms (wall time: 1 ms) have passed since, so that signals arrive. In wall
  /// time instant::max() means until a stop is requested; virtual time would jump there.
  /// @pre end >= now()
  stop_cause run_until(instant end);

  /// Executes what is ready without letting time pass or looking at stop requests.
  /// @returns false if something is still ready after `turns_max`
  bool drain(std::size_t turns_max);

  /// Ends the current run, or the next if there is none; each request ends one run. Thread-safe.
  void request_stop();

  /// From now on no timeout fires or is accepted.
  void close_clock() { clock_.close(); }

  /// Ends every actor that is alive, as by exit_reason::kill, so that their states are destroyed.
  /// No handler runs. Not for use inside a run.
  void kill_all();

  /// Forgets the loop; from now on wall time cannot pass.
  void detach_io();

  [[nodiscard]] instant now() const { return to_instant(clock_.now()); }
  [[nodiscard]] statistics stats() const;

  /// Time of the next timeout or delayed message; nothing if there is none.
  [[nodiscard]] std::optional<instant> next_timeout() { return clock_.next(); }

  /// The recorder that spawn helpers hand to actors; nullptr for none.
  [[nodiscard]] trace_recorder* trace() const { return trace_; }
  void trace(trace_recorder* x) { trace_ = x; }

  // what CAF calls
  run_clock& clock() noexcept override { return clock_; }
  void enqueue(caf::resumable* what) override;
  [[nodiscard]] bool detaches_utility_actors() const override { return false; }

protected:
  void init(caf::actor_system_config& config) override;
  void start() override;
  void stop() override;

private:
  /// What actors see of us while they have their turn.
  class unit final : public caf::execution_unit {
  public:
    unit(coordinator& owner, caf::actor_system& system) : execution_unit(&system), owner_(owner) {}
    void exec_later(caf::resumable* what) override { owner_.ready_.push(what); }

  private:
    coordinator& owner_;
  };

  void run_ready();
  void take_turn(caf::resumable* what);
  void count_turn();
  void wait_until(instant next);
  void accept_outside();
  void remember(const caf::scheduled_actor& actor);

  outside outside_;
  run_clock clock_;
  unit unit_;
  ready_queue<caf::resumable*> ready_;
  io::loop* loop_;
  trace_recorder* trace_ = nullptr;
  std::atomic<bool> stop_requested_ = false;
  std::uint64_t resumes_ = 0;
  unsigned turns_since_look_ = 0;
  std::chrono::steady_clock::time_point polled_;
  io::spare_memory spare_memory_;
  const duration poll_interval_;
  const std::size_t turns_per_round_;       ///< turns before timeouts are looked at again
  std::vector<caf::weak_actor_ptr> roster_; ///< actors that have had a turn, dead ones weeded out
  std::size_t roster_weeded_ = 64;          ///< size at which to weed again
};

} // namespace rubicon::scheduler
