// Since when something was bound to happen: futures that part from a run at some time are counted,
// and that time is narrowed down by halves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/time.hpp"

namespace rubicon::study {

/// Of futures that part from a run at one time.
struct future_count {
  duration at{};
  std::size_t with = 0;                 ///< in which it happens
  std::size_t of = 0;                   ///< all that were counted
  std::optional<std::uint64_t> without; ///< number of one in which it does not

  [[nodiscard]] bool all() const { return with == of; }

  friend bool operator==(const future_count&, const future_count&) = default;
};

/// Alternates between next() and take(). The chance of something may fall and rise again while a
/// run goes on: the time that is found is one from which it is certain, and shortly before was not.
class turning_point {
public:
  /// How many futures from `at` on have it.
  struct question {
    duration at{};
    bool counts_all = false; ///< else one without it is enough

    friend bool operator==(const question&, const question&) = default;
  };

  /// @param seen when it happened; the first guess
  /// @param end of the run, from which on nothing can be different
  /// @param within how exact the time is. @pre at least 1 ms; times are whole milliseconds
  turning_point(duration seen, duration end, duration within);

  /// Nothing: it has been found.
  [[nodiscard]] std::optional<question> next() const;

  /// The answer to next(). @pre x.of > 0
  void take(const future_count& x);

  // After the last question.
  [[nodiscard]] duration certain_from() const { return certain_from_; }
  [[nodiscard]] bool only_at_end() const { return certain_from_ >= end_; }
  /// The time shortly before; nothing: it was certain from the start.
  [[nodiscard]] const std::optional<future_count>& before() const { return before_; }
  [[nodiscard]] const future_count& at_start() const { return at_start_; }

private:
  enum class state : std::uint8_t { start, seen, between, before, ended };

  void look_between();

  duration seen_;
  duration end_;
  duration within_;
  state state_ = state::start;
  future_count at_start_;
  duration certain_from_;
  std::optional<future_count> before_;
};

} // namespace rubicon::study
