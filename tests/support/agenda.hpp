// What is to happen in a small world under virtual time.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "core/time.hpp"

namespace rubicon::test {

/// Events by time; of equal times the one added first comes first.
class agenda {
public:
  void add(instant when, std::function<void()> what) { events_.emplace(when, std::move(what)); }

  /// Lets events happen until `end`, and between them whoever has a deadline act.
  /// @param now moves on to `end`
  /// @param next the earliest deadline, `end` at the latest; an event goes before a deadline
  /// @param wake lets those act whose deadline is now
  template <class Next, class Wake>
  void run(instant& now, instant end, Next next, Wake wake) {
    while (true) {
      const instant due = next();
      if (!events_.empty() && events_.begin()->first <= due) {
        const auto event = events_.extract(events_.begin());
        now = std::max(now, event.key());
        event.mapped()();
      } else if (due < end) {
        now = std::max(now, due);
        wake();
      } else {
        now = end;
        return;
      }
    }
  }

private:
  std::multimap<instant, std::function<void()>> events_;
};

} // namespace rubicon::test
