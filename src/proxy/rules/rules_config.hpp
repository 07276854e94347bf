// What a file may say about rules, the smallest control program.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace rubicon::proxy {

/// Written to one key at its owner when a rule's condition comes to hold, and when it ends.
struct rule_write {
  std::string key;
  std::string then;      ///< empty: nothing is written
  std::string otherwise; ///< empty: nothing is written
  bool meta = false;     ///< a meta tuple, and both texts are `(META <owner> <key>)` (META-05)
  std::string from =
      {}; ///< instead of `then`: the value that this tuple, of any owner, has at that moment
};

/// When a tuple meets a condition, and has done so for long enough, writes others. The condition is
/// a threshold with hysteresis, or one of some texts. A threshold that is not given is the same as
/// the other one; without any condition the rule never writes, unless it has a time of day. @pre
/// below <= above if both are given
struct rule {
  std::string when;            ///< key watched, whoever owns it; keys have no letter case (TUP-03)
  std::optional<double> above; ///< holds at or above this,
  std::optional<double> below; ///< ends below this
  std::vector<std::string> equals; ///< holds while the text is one of these, ends with any other
  duration lasting{};              ///< holds for so long before `then` is written
  duration otherwise_lasting{};    ///< has ended for so long before `otherwise` is written
  std::vector<rule_write> writes;  ///< at least one
  duration after{}; ///< `then` is written so long after it has come to hold, though it may have
                    ///< ended since; anew when it comes to hold again
  /// Instead of when it changes, the condition counts at this time of each day, in time since the
  /// start of the run, 0 to 24 h: `then` if it holds, `otherwise` if not; without `when`: `then`.
  std::optional<duration> daily;
  bool retry = true; ///< what has not reached its owner is written again
};

/// Local time leaps, to or from daylight saving.
struct clock_change {
  instant at;
  duration ahead{}; ///< of what it would be without any change since the start, from then on

  friend bool operator==(const clock_change&, const clock_change&) = default;
};

struct rules_config {
  std::vector<rule> rules;                      ///< at least one
  duration retry = 5s;                          ///< after an actuation has failed; 0: never
  std::vector<clock_change> clock_changes = {}; ///< in order
};

/// The first moment, `from` or later, at which a rule's time of day comes. It comes once a day:
/// what a change leaves out comes at the change, what it repeats comes the first time.
[[nodiscard]] instant next_daily(duration daily, const std::vector<clock_change>& changes,
                                 instant from);

} // namespace rubicon::proxy
