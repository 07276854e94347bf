// Several logical processes in one run: who may be ahead of whom, and what they send each other
// (docs/architecture.md, Time).
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/time.hpp"
#include "parallel/horizons.hpp"
#include "parallel/timer_queue.hpp"
#include "parallel/workers.hpp"
#include "scheduler/process.hpp"
#include "scheduler/timeout.hpp"

namespace rubicon::scheduler {

/// When the supervisor reacts to one process, what it does to another takes so long: that may be so
/// far ahead.
inline constexpr duration supervision_delay = 10s;

/// Runs processes in rounds. One may run ahead of another as far as nothing can come from there
/// that it should have known (horizons). At one time the supervisor goes first if a timeout of its
/// own is due, and last, again and again, with what others have sent it. So nothing depends on how
/// far who runs ahead, nor on the number of threads.
///
///   begin --> next --> run_next --> next --> ... --> meet
class process_rounds {
public:
  using process_list = std::vector<std::unique_ptr<process>>;

  /// @param all the first is the supervisor's; others may be added at any time
  /// @param threads that execute events at the same time
  process_rounds(const process_list& all, unsigned threads) : processes_(all), threads_(threads) {}

  /// Declares that actors of `from` send to those of `to`, with at least this delay. @pre delay > 0
  void link(const process& from, const process& to, duration delay);

  /// When something arrives that is sent now, to be there at `due`.
  /// @throws std::logic_error if that is sooner than any link between the two permits
  [[nodiscard]] instant arrival(const process& from, const process& to, instant due) const;

  /// Takes a delayed message of the supervisor to itself, if it is a part of what it does about
  /// something that a process has sent it.
  [[nodiscard]] bool react_later(add_timeout& x);

  void begin();

  /// Takes over what was sent. @returns when one of them does something next; or never
  [[nodiscard]] instant next();

  /// Lets the supervisor do what is next for it, or others what they may do until it has something
  /// to do. @pre next() is at or before `end`, and nobody has done anything since
  /// @param ahead whether one may be ahead of another
  void run_next(instant end, bool ahead);

  /// Whether a process that has just run has given up in the middle of an instant
  /// (coordinator::gives_up).
  [[nodiscard]] bool is_stuck() const;

  /// Lets everything be said that was to be said before that time.
  void say_before(instant end);

  /// All have come to the same time.
  void meet(instant at);

  /// When the first message of other processes reaches the supervisor; or never.
  [[nodiscard]] instant next_arrival() const;

  /// Nothing that was sent arrives.
  void drop_sent();

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

  [[nodiscard]] process& supervisor() const { return *processes_.front(); }
  /// @returns whether the supervisor had something to do before others
  bool let_supervise(instant others);
  /// Lets all others run ahead as far as they may. @pre one of them has something to do before
  /// `end`
  void let_run(instant others, instant end, bool ahead);
  void run_round(bool may_share);
  /// Rounds are to be long, but nobody is to wait for them.
  void follow_pace(std::chrono::steady_clock::duration round);
  void take_over(process_output& from);
  [[nodiscard]] std::uint64_t turns_so_far() const; ///< of those in the round

  const process_list& processes_;
  parallel::horizons horizons_;
  std::vector<instant> next_; ///< of each process, from round to round
  instant first_of_others_{}; ///< the least of them: each message to the supervisor asks for it
  std::vector<remark_later> to_be_said_;
  std::vector<runner> round_; ///< who had something to do, until what they have sent is taken over
  std::uint64_t turns_of_round_ = 0;
  std::unique_ptr<parallel::workers> workers_; ///< from the first round that pays for them
  const unsigned threads_;
  parallel::timer_queue<arrival_at_supervisor> arrivals_;
  instant together_at_{};          ///< when the supervisor has last acted of itself
  const process* cause_ = nullptr; ///< whom the supervisor reacts to; nullptr: it acts of itself,
                                   ///< and nobody is ahead of it
  duration reach_ = reach_min;     ///< how far others run ahead of each other

  /// How far one process runs ahead of another at first.
  static constexpr duration reach_min = 10ms;
};

} // namespace rubicon::scheduler
