#include "cli/print/local_time.hpp"

#include <array>
#include <cstdio>
#include <ctime>

namespace rubicon::cli {

namespace {

std::tm local(std::time_t x) {
  std::tm parts{};
  localtime_r(&x, &parts);
  return parts;
}

/// The first moment after `from` at which the clock is not as far from UTC as then.
std::time_t leap_between(std::time_t from, std::time_t to) {
  const auto as_before = local(from).tm_gmtoff;
  while (to - from > 1) {
    const auto middle = from + (to - from) / 2;
    (local(middle).tm_gmtoff == as_before ? from : to) = middle;
  }
  return to;
}

} // namespace

duration time_of_day(std::chrono::system_clock::time_point at) {
  const auto parts = local(std::chrono::system_clock::to_time_t(at));
  return parts.tm_hour * 1h + parts.tm_min * 1min + parts.tm_sec * 1s;
}

std::string clock_now(bool milliseconds) {
  const auto now = std::chrono::system_clock::now();
  const auto parts = local(std::chrono::system_clock::to_time_t(now));
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch());
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%02d:%02d:%02d", parts.tm_hour, parts.tm_min,
                parts.tm_sec);
  std::string shown = text.data();
  if (milliseconds) {
    std::snprintf(text.data(), text.size(), ".%03d", static_cast<int>(ms.count() % 1000));
    shown += text.data();
  }
  return shown;
}

std::vector<proxy::clock_change> clock_changes(std::chrono::system_clock::time_point begin,
                                               duration length) {
  constexpr std::time_t step = 24 * 3600; // no zone changes its clock twice in a day
  const auto first = std::chrono::system_clock::to_time_t(begin);
  const auto end = first + length / 1s;
  const auto at_first = local(first).tm_gmtoff;
  std::vector<proxy::clock_change> all;
  for (auto x = first; x < end; x += step) {
    const auto next = x + step;
    if (local(x).tm_gmtoff == local(next).tm_gmtoff)
      continue;
    const auto leap = leap_between(x, next);
    all.push_back({instant{} + (leap - first) * 1s, (local(next).tm_gmtoff - at_first) * 1s});
  }
  return all;
}

} // namespace rubicon::cli
