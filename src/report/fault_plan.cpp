#include "report/fault_plan.hpp"

#include <algorithm>
#include <string>

#include "core/random.hpp"

namespace rubicon::report {

std::vector<planned_fault> plan_faults(const config::ecology_description& x) {
  std::vector<planned_fault> plan;
  for (std::uint32_t index = 0; index < x.faults.size(); ++index) {
    const auto& fault = x.faults[index];
    if (!fault.repeated) {
      plan.push_back({fault.at, index});
      continue;
    }
    const auto& times = *fault.repeated;
    const auto until = std::min(times.until.value_or(x.length), x.length);
    if (until < times.from)
      continue; // the run has been made shorter than the file says
    if (times.every > duration{}) {
      for (auto at = times.from; at <= until; at += times.every)
        plan.push_back({at, index});
    }
    random_stream rng(x.seed, "fault/" + std::to_string(index));
    for (std::uint32_t i = 0; i < times.count; ++i)
      plan.push_back({rng.between(times.from, until), index});
  }
  std::ranges::stable_sort(plan, {}, &planned_fault::at);
  std::erase_if(plan, [&x](const auto& each) { return each.at > x.length; });
  return plan;
}

} // namespace rubicon::report
