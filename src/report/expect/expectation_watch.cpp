#include "report/expect/expectation_watch.hpp"

#include <algorithm>

#include "report/figures.hpp"

namespace rubicon::report {

namespace {

/// Times that may wait for one tuple: further ones count as the newest of them.
constexpr std::size_t waiting_max = 10'000;

} // namespace

void tuple_watch::begin(instant now) {
  if (waiting.size() == waiting_max)
    return;
  ++times;
  waiting.push_back(now);
}

void tuple_watch::come_true(const config::tuple_expectation& what, instant now) {
  expire(what, now);
  for (const auto since : waiting)
    slowest = std::max(slowest, now - since);
  met += waiting.size();
  waiting.clear();
}

void tuple_watch::expire(const config::tuple_expectation& what, instant now) {
  while (!waiting.empty() && now - waiting.front() > what.within) {
    if (!missed)
      missed = waiting.front();
    waiting.pop_front();
  }
}

void clock_watch::take(const config::clock_expectation& what, const std::string& mote,
                       duration error, instant now) {
  ++samples;
  if (error > worst) {
    worst = error;
    worst_at = mote + " at " + run_time(now);
  }
  if (error <= what.at_most)
    return;
  ++bad;
  if (!first_bad)
    first_bad = now;
}

void log_watch::take(const config::event_log_expectation& what, const logged_event& line) {
  if (line.what.find(what.text) == std::string::npos ||
      line.who.find(what.who) == std::string::npos)
    return;
  ++count;
  last = line.at;
}

} // namespace rubicon::report
