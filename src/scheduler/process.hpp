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
#include <caf/execution_unit.hpp>
#include <caf/resumable.hpp>

#include "core/time.hpp"
#include "parallel/horizons.hpp"
#include "parallel/ready_queue.hpp"
#include "scheduler/messages/envelope_pool.hpp"
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
    return !ready_.empty() ? now() : timeouts_.next().value_or(parallel::never);
  }

  /// Executes every event before `end`, but goes no further than an instant at which it has sent
  /// something to the supervisor.
  void run_before(instant end);

  /// Executes its next instant. @pre it has one
  void run_instant();

  /// Hands out what is due next, but gives nobody a turn. @pre it is due before never
  void fire_next();

  /// @pre anybody_ready()
  void give_turn();

  [[nodiscard]] bool anybody_ready() const { return !ready_.empty(); }
  void make_ready(actor& what);

  /// Of CAF's own kinds. @param what with one reference count
  void make_ready(caf::resumable* what) { ready_.push({nullptr, what}); }

  /// The place of something that comes from the actor that has its turn. Not before now().
  [[nodiscard]] parallel::event_order order_of(instant due);

  /// The same for who sees a process as one: what it has done is in the order in which it was done.
  [[nodiscard]] parallel::event_order order_as_one(instant due);

  /// Delivers `content` at `due`, or now if that is past, unless it is moved or taken back before.
  /// It comes from nothing but the time. @pre the receiver is one of its own
  [[nodiscard]] movable_message schedule(instant due, caf::strong_actor_ptr receiver,
                                         envelope_ptr content);

  /// Delivers it at `due` instead.
  /// @returns false if there is nothing to move: it was delivered or taken back
  [[nodiscard]] bool move(const movable_message& x, instant due) {
    return timeouts_.move(x, order_of(due));
  }

  /// Takes it back; harmless if it was delivered.
  void cancel(const movable_message& x) { timeouts_.cancel(x); }

  [[nodiscard]] timeout_table& timeouts() { return timeouts_; }
  [[nodiscard]] const timeout_table& timeouts() const { return timeouts_; }

  /// Hands something to another process. @param due nothing: as soon as may be
  /// @throws std::logic_error if that process could be ahead of it already
  void send(process& to, timeout what, std::optional<instant> due);

  [[nodiscard]] std::vector<crossing>& sent() { return sent_; }

  /// Says something to people in the order of time, whoever is ahead: now or soon.
  void say(std::function<void()> what);
  [[nodiscard]] std::vector<remark_later>& to_be_said() { return to_be_said_; }

  [[nodiscard]] caf::execution_unit& unit() { return unit_; }
  [[nodiscard]] std::uint64_t turns() const { return turns_; }

  /// Where deliveries to its actors are folded. @pre one was given
  [[nodiscard]] trace_part& trace() { return *trace_; }
  void trace(trace_part& x) { trace_ = &x; }

  /// Who has its turn, until the caller ends it.
  [[nodiscard]] traced_base* acting(traced_base* x) { return std::exchange(acting_, x); }

  /// Who sees all messages to its actors before they are delivered; nullptr: nobody.
  [[nodiscard]] delivery_tap* tap() const { return tap_; }
  void tap(delivery_tap* x) { tap_ = x; }

  /// Ends every actor that has had a turn or is about to. @returns whether there was any
  bool kill_all();

private:
  friend class entered;

  class execution final : public caf::execution_unit {
  public:
    execution(process& owner, caf::actor_system& system) : execution_unit(&system), owner_(owner) {}
    void exec_later(caf::resumable* what) override { owner_.make_ready(what); }

  private:
    process& owner_;
  };

  /// Who waits for a turn, with one reference count: an actor of ours, or one of CAF's.
  struct turn_taker {
    actor* own = nullptr;
    caf::resumable* of_caf = nullptr;
  };

  void give_turn(actor& whom);
  void give_turn(caf::resumable* whom);
  void remember(actor& whom);

  coordinator& owner_;
  const std::size_t number_;
  execution unit_;
  std::atomic<std::int64_t> now_ns_ = 0;
  envelope_pool envelopes_;
  parallel::ready_queue<turn_taker> ready_;
  timeout_table timeouts_;
  std::vector<crossing> sent_;
  std::vector<remark_later> to_be_said_;
  std::optional<instant> sent_supervisor_at_; ///< when it sent it something last
  traced_base* acting_ = nullptr;
  std::uint64_t sequence_ = 0;
  std::uint64_t turns_ = 0;
  trace_part* trace_ = nullptr;
  delivery_tap* tap_ = nullptr;
  std::vector<caf::weak_actor_ptr> roster_; ///< actors that have had a turn, dead ones weeded out
  std::size_t roster_weeded_ = 64;          ///< size at which to weed again
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
