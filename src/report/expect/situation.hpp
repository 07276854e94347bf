// Conditions of expectations on the tuples of a run, and situations that some run of a swarm must
// come into ([[expect]] kind = "sometimes").
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "config/plan/expectation.hpp"
#include "core/time.hpp"
#include "report/report.hpp"

namespace rubicon::report {

/// Keys have no letter case (TUP-03).
[[nodiscard]] bool equal_keys(std::string_view a, std::string_view b);

/// @param text nullptr: the tuple is not there
[[nodiscard]] bool holds(const config::tuple_condition& x, const std::string* text);

/// What the text of an expectation of a situation begins with; its name follows.
inline constexpr std::string_view sometimes = "sometimes ";

/// Whether and when a run has come into one. Receives tuples and lines of the event log in the
/// order of their times.
class situation {
public:
  /// @param text nullptr: the tuple is not there
  void on_tuple(const config::sometimes_expectation& what, std::string_view key,
                const std::string* text, instant now);

  void on_event(const config::sometimes_expectation& what, const logged_event& x);

  [[nodiscard]] std::uint64_t times() const { return times_; }
  [[nodiscard]] std::optional<instant> first() const { return first_; }

private:
  void reach(instant now);

  bool holds_ = false;            ///< `during`
  std::optional<instant> before_; ///< the newest line of `after`
  std::uint64_t times_ = 0;
  std::optional<instant> first_;
};

} // namespace rubicon::report
