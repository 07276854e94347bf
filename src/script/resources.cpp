#include "script/resources.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/text/printable.hpp"

namespace rubicon::script {

// -- timers

std::optional<std::uint32_t> resources::add_timer(instant now, duration after, bool repeats,
                                                  int function) {
  if (timers_.size() >= timers_max)
    return std::nullopt;
  timers_.push_back({++timers_so_far_, now + after, repeats ? after : duration{}, function});
  return timers_so_far_;
}

std::optional<int> resources::remove_timer(std::uint32_t number) {
  const auto found = std::ranges::find(timers_, number, &timer::number);
  if (found == timers_.end())
    return std::nullopt;
  const int function = found->function;
  timers_.erase(found);
  return function;
}

std::optional<instant> resources::deadline() const {
  std::optional<instant> first;
  for (const auto& x : timers_)
    first = earliest(first, x.due);
  return first;
}

std::vector<std::uint32_t> resources::due(instant now) const {
  std::vector<std::pair<instant, std::uint32_t>> all;
  for (const auto& x : timers_)
    if (x.due <= now)
      all.emplace_back(x.due, x.number);
  std::ranges::sort(all);
  std::vector<std::uint32_t> numbers;
  for (const auto& x : all)
    numbers.push_back(x.second);
  return numbers;
}

std::optional<resources::expiry> resources::expire(std::uint32_t number, instant now) {
  const auto found = std::ranges::find(timers_, number, &timer::number);
  if (found == timers_.end())
    return std::nullopt;
  const expiry x{found->function, found->period.count() == 0};
  if (x.is_last)
    timers_.erase(found);
  else
    found->due += ((now - found->due) / found->period + 1) * found->period;
  return x;
}

// -- what it reports

const char* resources::add_notice() {
  return ++notices_ > notices_max ? "more than 16 notices and warnings in one event" : nullptr;
}

const char* resources::set_figure(std::string_view name, double value) {
  const auto found = std::ranges::find(figures_, name, &apps::figure::name);
  if (found != figures_.end()) {
    found->value = value;
    return nullptr;
  }
  if (figures_.size() >= figures_max)
    return "more than 16 figures";
  if (name.empty() || name.size() > text_max || name == "events" || name == "instructions" ||
      printable(name) != name)
    return "no name of a figure: it is empty, too long, not printable, or the program's own";
  figures_.push_back({std::string(name), value, false});
  return nullptr;
}

} // namespace rubicon::script
