// A logical process: actors that share one time, and what is to happen to them.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <caf/actor_control_block.hpp>

#include "core/time.hpp"
#include "parallel/horizons.hpp"
#include "scheduler/messages/envelope_pool.hpp"
#include "scheduler/run_queue.hpp"
#include "scheduler/timeout_table.hpp"
#include "scheduler/trace.hpp"

namespace rubicon::scheduler {

class actor;
class coordinator;
class process;

/// Sees messages before they are delivered, and may keep them: for tests.
class delivery_tap {
public:
  /// @returns whether it keeps the message, which is moved out then
  [[nodiscard]] virtual bool takes(actor& to, envelope_ptr& x, actor* from) = 0;

protected:
  ~delivery_tap() = default;
};

/// A message in transit to an actor of another process.
struct crossing {
  process* from = nullptr;
  process* to = nullptr;
  parallel::event_order when;
  timeout what;
};

/// Something for people, to be said when nothing earlier can be any more.
struct remark_later {
  parallel::event_order when;
  std::function<void()> say;
};

/// What a process has for others, until the coordinator takes it over.
struct process_output {
  std::vector<crossing> sent;
  std::vector<remark_later> remarks;
};

/// Who sees what is delivered to the actors of a process; nullptr: none.
struct delivery_watch {
  trace_part* trace = nullptr; ///< where deliveries are folded
  delivery_tap* tap = nullptr; ///< sees all messages before they are delivered
};

/// One thread at a time runs it; nothing in it is for others at that time. The first of a
/// coordinator is the supervisor: it sends to all others, and all others to it, without delay.
class process {
public:
  process(coordinator& owner, caf::actor_system& system, std::size_t number);
  process(const process&) = delete;
  process& operator=(const process&) = delete;

  /// Whose events this thread executes; nullptr: nobody's.
  [[nodiscard]] static process* current() { return executed_process; }

  [[nodiscard]] coordinator& owner() { return owner_; }
  [[nodiscard]] std::size_t number() const { return number_; } ///< 0: the supervisor
  [[nodiscard]] bool supervises() const { return number_ == 0; }

  /// The time of the last event, or later: it is never again earlier. Thread-safe.
  [[nodiscard]] instant now() const {
    return instant(duration(now_ns_.load(std::memory_order_relaxed)));
  }

  /// It is now at least `x`.
  void advance(instant x);

  /// When it does something next, if nobody sends it anything.
  [[nodiscard]] instant next() const {
    return !queue_.empty() ? now() : timeouts_.next().value_or(parallel::never);
  }

  /// Executes every event before `end`, but goes no further than an instant at which it has sent
  /// something to the supervisor.
  void run_before(instant end);

  /// Executes its next instant. @pre it has one
  void run_instant();

  /// Hands out what is due next, but gives nobody a turn. @pre it is due before never
  void fire_next();

  /// @pre the queue is not empty
  void give_turn();

  [[nodiscard]] run_queue& queue() { return queue_; }

  /// The place of something that comes from the actor that has its turn. Not before now().
  [[nodiscard]] parallel::event_order order_of(instant due);

  /// Delivers `content` at `due`, or now if that is past, unless it is moved or taken back before.
  /// It comes from nothing but the time. @pre the receiver is one of its own
  [[nodiscard]] movable_message schedule(instant due, caf::strong_actor_ptr receiver,
                                         envelope_ptr content);

  /// Delivers it at `due` instead.
  /// @returns false if there is nothing to move: it was delivered or taken back
  [[nodiscard]] bool move(const movable_message& x, instant due) {
    return timeouts_.move(x, order_of(due));
  }

  [[nodiscard]] timeout_table& timeouts() { return timeouts_; }

  /// Hands something to another process. @param due nothing: as soon as may be
  /// @throws std::logic_error if that process could be ahead of it already
  void send(process& to, timeout what, std::optional<instant> due);

  /// Says something to people in the order of time, whoever is ahead: now or soon.
  void say(std::function<void()> what);

  [[nodiscard]] process_output& output() { return output_; }
  [[nodiscard]] delivery_watch& watch() { return watch_; }
  [[nodiscard]] envelope_pool& envelopes() { return envelopes_; }

  /// Who has its turn, until the caller ends it.
  [[nodiscard]] traced_base* acting(traced_base* x) { return std::exchange(acting_, x); }

private:
  /// The place of what is seen as done by the process, not by an actor: in the order in which it
  /// was done.
  [[nodiscard]] parallel::event_order order_as_one(instant due);

  coordinator& owner_;
  const std::size_t number_;
  std::atomic<std::int64_t> now_ns_ = 0;
  envelope_pool envelopes_;
  run_queue queue_;
  timeout_table timeouts_;
  process_output output_;
  delivery_watch watch_;
  std::optional<instant> sent_supervisor_at_; ///< when it sent it something last
  traced_base* acting_ = nullptr;
  std::uint64_t sequence_ = 0;
};

/// While this lives, its thread executes events of that process.
class entered {
public:
  explicit entered(process* which);
  ~entered();
  entered(const entered&) = delete;
  entered& operator=(const entered&) = delete;

private:
  process* before_;
  envelope_pool* pool_before_;
};

} // namespace rubicon::scheduler
