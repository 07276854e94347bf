// The run queue of one logical process: who waits for a turn, and who ever had one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <caf/actor_control_block.hpp>
#include <caf/execution_unit.hpp>
#include <caf/resumable.hpp>

#include "parallel/ready_queue.hpp"

namespace rubicon::scheduler {

class actor;
class process;

/// First in, first out. Not thread-safe.
class run_queue {
public:
  run_queue(process& owner, caf::actor_system& system) : owner_(owner), unit_(*this, system) {}
  run_queue(const run_queue&) = delete;
  run_queue& operator=(const run_queue&) = delete;

  [[nodiscard]] bool empty() const { return ready_.empty(); }
  void push(actor& what);

  /// Of CAF's own kinds. @param what with one reference count
  void push(caf::resumable* what) { ready_.push({nullptr, what}); }

  /// Gives the first its turn. @param messages_max that it may handle in it @pre !empty()
  void give_turn(std::size_t messages_max);

  /// Turns so far.
  [[nodiscard]] std::uint64_t turns() const { return turns_; }

  /// As CAF sees it.
  [[nodiscard]] caf::execution_unit& unit() { return unit_; }

  /// Ends every actor that has had a turn or is about to. @returns whether there was any
  bool kill_all();

private:
  class execution final : public caf::execution_unit {
  public:
    execution(run_queue& owner, caf::actor_system& system)
        : execution_unit(&system), owner_(owner) {}
    void exec_later(caf::resumable* what) override { owner_.push(what); }

  private:
    run_queue& owner_;
  };

  /// Who waits for a turn, with one reference count: an actor of ours, or one of CAF's.
  struct turn_taker {
    actor* own = nullptr;
    caf::resumable* of_caf = nullptr;
  };

  void give_turn(actor& whom, std::size_t messages_max);
  void give_turn(caf::resumable* whom, std::size_t messages_max);
  void remember(actor& whom);

  process& owner_;
  execution unit_;
  parallel::ready_queue<turn_taker> ready_;
  std::uint64_t turns_ = 0;
  std::vector<caf::weak_actor_ptr> roster_; ///< actors that have had a turn, dead ones weeded out
  std::size_t roster_weeded_ = 64;          ///< size at which to weed again
};

} // namespace rubicon::scheduler
