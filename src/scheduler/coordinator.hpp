// The scheduler module for CAF: virtual time, also of several processes at once, or wall time
// (docs/architecture.md, Time; GEN-07, NFR-08).
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <caf/actor_system_config.hpp>
#include <caf/resumable.hpp>
#include <caf/scheduler/abstract_coordinator.hpp>

#include "core/time.hpp"
#include "io/process/spare_memory.hpp"
#include "parallel/horizons.hpp"
#include "parallel/workers.hpp"
#include "scheduler/outside.hpp"
#include "scheduler/process.hpp"
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
  unsigned threads = 1;     ///< that execute events at the same time, in virtual time without pace
  bool in_order = false;    ///< as in world_options; so it is in paced time and while observed
};

/// When the supervisor reacts to one process, what it does to another takes so long: that may be so
/// far ahead.
inline constexpr duration supervision_delay = 10s;

/// The configuration that installs the coordinator and carries its options.
struct coordinator_config : caf::actor_system_config {
  explicit coordinator_config(coordinator_options x);

  coordinator_options options;
};

/// Runs actors and timeouts. Each process has its own: ready actors in first in, first out order;
/// when none is ready, the timeouts of the next time at which there are any
/// (parallel::event_order). In wall time there is one process, whose loop waits; sockets share its
/// thread.
///
/// In virtual time there may be several. One may run ahead of another as far as nothing can come
/// from there that it should have known (horizons). At one time the supervisor goes first if a
/// timeout of its own is due, and last, again and again, with what others have sent it. So nothing
/// depends on how far who runs ahead, nor on the number of threads. While events are observed, and
/// in time that is paced, nobody runs ahead.
///
/// Threads that execute no process may send messages, also delayed ones, and ask for a stop; what
/// they ask is taken over by the thread that made the actor system in the order it was asked.
/// In virtual time such a run is not repeatable.
class coordinator final : public caf::scheduler::abstract_coordinator {
public:
  explicit coordinator(caf::actor_system& system);
  ~coordinator() override;

  /// What actor_system_config::load asks for.
  static caf::actor_system::module* make(caf::actor_system& system, caf::detail::type_list<>);

  /// The coordinator of a system; nullptr if another scheduler is installed.
  [[nodiscard]] static coordinator* of(caf::actor_system& system);

  /// One more process, for actors that may be ahead of others. In wall time there is but the
  /// supervisor's, which is the one that is returned. Lives as long as the coordinator.
  [[nodiscard]] process& add_process();

  /// Declares that actors of `from` send to those of `to`, with at least this delay. @pre delay > 0
  void link(const process& from, const process& to, duration delay);

  /// The process of whoever supervises all others, and of everybody who was placed in no other.
  [[nodiscard]] process& supervisor() { return *processes_.front(); }

  /// Executes every event at or before `end`, ending the run early if a stop is requested: looked
  /// at before every turn if there is one process, and between their rounds if there are several,
  /// who then come to the same time. A turn is at most 50 messages of one actor. The loop is polled
  /// at least every 16 turns if 10 ms (wall time: 1 ms) have passed since, so that signals arrive.
  /// In wall time instant::max() means until a stop is requested; virtual time would jump there.
  /// @pre end >= now()
  stop_cause run_until(instant end);

  /// Executes what is ready without letting time pass or looking at stop requests.
  /// @returns false if something is still ready after `turns_max`
  bool drain(std::size_t turns_max);

  /// From now on events happen in the order of their time, one after the other, as with
  /// coordinator_options::in_order, or no longer: that changes nothing but when who may see what,
  /// so that a stop which somebody requests while an event is handled comes at the time of that
  /// event. Not for use inside a run.
  void keep_in_order(bool x) { requires_order_ = x; }

  /// Ends the current run, or the next if there is none; each request ends one run. Thread-safe.
  void request_stop();

  /// From now on no timeout fires or is accepted.
  void close_clock();

  /// Ends every actor that is alive, as by exit_reason::kill, so that their states are destroyed.
  /// No handler runs. Not for use inside a run.
  void kill_all();

  /// Forgets the loop; from now on wall time cannot pass.
  void detach_io();

  /// Of the process that this thread executes; outside of all, the supervisor's, which then is
  /// that of all.
  [[nodiscard]] instant now() const { return to_instant(clock_.now()); }
  [[nodiscard]] statistics stats() const;

  /// Time of the next timeout or delayed message; nothing if there is none.
  [[nodiscard]] std::optional<instant> next_timeout() const;

  /// The recorder that spawn helpers hand to actors; nullptr for none.
  [[nodiscard]] trace_recorder* trace() const { return trace_; }
  void trace(trace_recorder* x);

  // what processes call

  /// As whom this thread sends: the process that it executes, or the supervisor. nullptr: it is a
  /// thread that executes none.
  [[nodiscard]] process* sender_here();

  /// When something arrives that is sent now, to be there at `due`.
  [[nodiscard]] instant arrival(const process& from, const process& to, instant due) const;

  /// Takes a delayed message of the supervisor to itself, if it is a part of what it does about
  /// something that a process has sent it.
  [[nodiscard]] bool react_later(add_timeout& x);

  /// Whether an instant that has given so many turns is to be broken off: a stop is requested, or
  /// nobody expects it to end.
  [[nodiscard]] bool gives_up(std::uint64_t turns) const;

  /// Whether some process may be ahead of another.
  [[nodiscard]] bool runs_ahead() const {
    return processes_.size() > 1 && !in_order_ && !requires_order_ &&
           (trace_ == nullptr || !trace_->is_observed());
  }

  /// Polls the loop from time to time, if this is its thread.
  void on_turn();

  using abstract_coordinator::max_throughput;

  // what CAF calls
  run_clock& clock() noexcept override { return clock_; }
  void enqueue(caf::resumable* what) override;
  [[nodiscard]] bool detaches_utility_actors() const override { return false; }

protected:
  void init(caf::actor_system_config& config) override;
  void start() override;
  void stop() override;

private:
  /// What a process has sent the supervisor, and what that will do about it.
  struct arrival_at_supervisor {
    process* cause = nullptr;
    timeout what;
  };

  /// A process in a round, and up to where it may run.
  struct runner {
    process* who = nullptr;
    instant end;
  };

  stop_cause run_alone(instant end);
  stop_cause run_together(instant end);

  /// drain() of several processes.
  bool drain_together(std::size_t turns_max);
  /// Lets the supervisor do what is next for it, if nobody has anything to do before.
  /// @param others when the first of the others does something
  /// @returns whether it did
  bool let_supervise(instant others);
  /// Lets all others run ahead as far as they may. @pre one of them has something to do before
  /// `end`
  void let_run(instant others, instant end);
  /// Rounds are to be long, but nobody is to wait for them.
  void follow_pace(std::chrono::steady_clock::duration round);
  void take_over_sent();
  void update_next();
  void find_first();
  [[nodiscard]] instant next_of_others();
  /// When the first message of other processes reaches the supervisor; or never.
  [[nodiscard]] instant next_arrival() const;
  [[nodiscard]] std::uint64_t turns_so_far() const; ///< of those in the round
  /// Lets everything be said that was to be said before that time.
  void say_before(instant end);
  /// All others have come to the same time.
  void meet(instant at);

  [[nodiscard]] bool somebody_is_stuck() const;

  void run_ready();
  void wait_until(instant next);
  void accept_outside();

  outside outside_;
  std::vector<std::unique_ptr<process>> processes_; ///< the first is the supervisor's
  run_clock clock_;
  parallel::horizons horizons_;
  /// Of each process, from round to round; in the supervisor's place the earliest of all others.
  std::vector<instant> next_;
  std::vector<remark_later> to_be_said_;
  std::vector<runner> round_; ///< who had something to do, until what they have sent is taken over
  std::uint64_t turns_of_round_ = 0;
  std::unique_ptr<parallel::workers> workers_; ///< from the first round that pays for them
  const unsigned threads_;
  parallel::timer_queue<arrival_at_supervisor> arrivals_;
  instant together_at_{};          ///< when the supervisor has last acted of itself
  const process* cause_ = nullptr; ///< whom the supervisor reacts to; nullptr: it acts of itself,
                                   ///< and nobody is ahead of it
  duration reach_;                 ///< how far others run ahead of each other
  io::loop* loop_;
  trace_recorder* trace_ = nullptr;
  std::atomic<bool> stop_requested_ = false;
  std::uint64_t turns_max_ = std::numeric_limits<std::uint64_t>::max(); ///< at one instant
  unsigned turns_since_look_ = 0;
  std::chrono::steady_clock::time_point polled_;
  io::spare_memory spare_memory_;
  const duration poll_interval_;
  const bool wall_;
  const bool in_order_;
  bool requires_order_ = false;
};

} // namespace rubicon::scheduler
