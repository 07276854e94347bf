#include "report/fault_plan.hpp"

#include <algorithm>
#include <string>

#include "core/numbers/random.hpp"

namespace rubicon::report {

std::vector<duration> times_of(const config::fault_description& x, std::uint32_t index,
                               std::uint64_t seed, duration length) {
  if (!x.repeated)
    return x.at > length ? std::vector<duration>() : std::vector{x.at};
  const auto& times = *x.repeated;
  const auto until = std::min(times.until.value_or(length), length);
  if (until < times.from)
    return {}; // the run has been made shorter than the file says
  std::vector<duration> all;
  if (times.every > duration{}) {
    for (auto at = times.from; at <= until; at += times.every)
      all.push_back(at);
  }
  random_stream rng(seed, "fault/" + std::to_string(index));
  for (std::uint32_t i = 0; i < times.count; ++i)
    all.push_back(rng.between(times.from, until));
  std::ranges::sort(all);
  return all;
}

std::vector<planned_fault> plan_faults(const config::ecology_description& x) {
  std::vector<planned_fault> plan;
  for (std::uint32_t index = 0; index < x.faults.size(); ++index)
    for (const auto at : times_of(x.faults[index], index, x.seed, x.length))
      plan.push_back({at, index});
  std::ranges::stable_sort(plan, {}, &planned_fault::at);
  return plan;
}

} // namespace rubicon::report
