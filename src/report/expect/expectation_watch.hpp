// What is noticed of an expectation while its run goes on.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "config/plan/expectation.hpp"
#include "core/time.hpp"
#include "report/expect/situation.hpp"
#include "report/report.hpp"

namespace rubicon::report {

/// The tuples of one expectation.
struct tuple_watch {
  /// `then` is due since now.
  void begin(instant now);
  /// `then` is true.
  void come_true(const config::tuple_expectation& what, instant now);
  /// Forgets those times that it is too late for.
  void expire(const config::tuple_expectation& what, instant now);

  bool when_holds = false;
  bool then_holds = false;
  std::deque<instant> waiting; ///< times since which `then` is due, ascending
  std::uint64_t times = 0;     ///< it has come to be due
  std::uint64_t met = 0;
  duration slowest{};
  std::optional<instant> missed; ///< the first time it was due and did not come
};

/// Samples of one expectation.
struct clock_watch {
  void take(const config::clock_expectation& what, const std::string& mote, duration error,
            instant now);

  instant next;
  std::uint64_t samples = 0;
  std::uint64_t bad = 0;
  duration worst{};
  std::string worst_at; ///< mote
  std::optional<instant> first_bad;
};

struct vectors_watch {
  bool is_due = true;
  /// Missed until `from`, by node and program.
  std::map<std::pair<std::string, std::uint32_t>, std::uint64_t> before;
};

struct log_watch {
  void take(const config::event_log_expectation& what, const logged_event& line);

  std::uint64_t count = 0;
  std::optional<instant> last;
};

/// An expectation with what was noticed of it: of its kind's part.
struct watched_expectation {
  config::expectation what;
  tuple_watch tuples = {};
  clock_watch clocks = {};
  vectors_watch vectors = {};
  log_watch log = {};
  report::situation situation = {};
};

} // namespace rubicon::report
