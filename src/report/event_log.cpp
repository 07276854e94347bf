#include "report/event_log.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::report {

namespace {

void drop_one(std::vector<logged_event>& log) {
  auto least = duration::max();
  std::size_t at = 1;
  for (std::size_t i = 1; i + 1 < log.size(); ++i) {
    const auto gap = log[i + 1].at - log[i - 1].at;
    if (gap < least) {
      least = gap;
      at = i;
    }
  }
  log.erase(log.begin() + static_cast<std::ptrdiff_t>(at));
}

} // namespace

void add_event(std::vector<logged_event>& log, std::uint64_t& left_out, logged_event x,
               std::size_t lines_max) {
  assert(lines_max > 2);
  log.push_back(std::move(x));
  if (log.size() <= lines_max)
    return;
  drop_one(log);
  ++left_out;
}

std::uint64_t thin(std::vector<logged_event>& log, std::size_t lines_max) {
  assert(lines_max > 2);
  std::vector<logged_event> kept;
  std::uint64_t left_out = 0;
  for (auto& x : log)
    add_event(kept, left_out, std::move(x), lines_max);
  log = std::move(kept);
  return left_out;
}

} // namespace rubicon::report
