// Everything that is to happen at a time in one logical process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "parallel/timer_queue.hpp"
#include "scheduler/timeout.hpp"

namespace rubicon::scheduler {

/// A delayed message that may be moved or taken back until it is delivered. A value; owns nothing.
struct movable_message {
  std::uint32_t slot = 0;
  std::uint64_t number = 0; ///< 0: none
};

class process;

/// Hands a timeout to whom it is for. @param here executes it
void ship(timeout& x, process& here);

/// What waits, earliest first (parallel::event_order). Not thread-safe.
class timeout_table {
public:
  [[nodiscard]] std::size_t size() const { return timers_.size(); }

  /// When something is due next.
  [[nodiscard]] std::optional<instant> next() const { return timers_.next(); }

  /// Hands out everything that is due at *next(). @pre next()
  void fire_next(process& here);

  void add(const parallel::event_order& when, timeout what);

  /// It may be moved or taken back.
  [[nodiscard]] movable_message add_movable(const parallel::event_order& when, timeout what);

  /// @returns false if there is nothing to move: it was delivered or taken back
  [[nodiscard]] bool move(const movable_message& x, const parallel::event_order& when);

  /// Takes it back; harmless if it was delivered.
  void cancel(const movable_message& x);

  void clear();

  /// Forgets all; none is accepted from now on.
  void close();

  /// How many have fired.
  [[nodiscard]] std::uint64_t fired() const { return fired_; }

private:
  [[nodiscard]] bool pending(const movable_message& x) const;

  bool closed_ = false;
  parallel::timer_queue<timeout> timers_;
  std::uint64_t movable_messages_ = 0; ///< so far
  std::uint64_t fired_ = 0;
};

} // namespace rubicon::scheduler
