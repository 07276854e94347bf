// Counters by their names, as the report has them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/describe/fields.hpp"

namespace rubicon::report {

/// Counts by cause; ordered by name, so that equal runs print equal reports.
using cause_counts = std::map<std::string, std::uint64_t>;

/// Adds the counters of a module to those of others, each as `module.name`, those by cause as
/// `module.name.cause`, unless it is 0. What is no count is left out. The struct is always named:
/// tests/architecture/counters_shown looks for it.
template <described Counters>
void add_counters(cause_counts& sum, const std::string& module, const Counters& x) {
  // Most counters of most modules are 0: only those that are not cost the making of a name.
  const auto add = [&](std::string_view field, std::uint64_t count, std::string_view cause = {}) {
    if (count == 0)
      return;
    auto name = module;
    name.append(1, '.').append(field);
    if (!cause.empty())
      name.append(1, '.').append(cause);
    sum[std::move(name)] += count;
  };
  for_each_field(x, [&](std::string_view field, const auto& counted) {
    if constexpr (std::is_convertible_v<decltype(counted), std::uint64_t>)
      add(field, counted);
    else if constexpr (requires { counted.begin()->second > 0; })
      for (const auto& [cause, count] : counted)
        add(field, count, cause);
  });
}

/// The sum over all causes.
[[nodiscard]] std::uint64_t total(const cause_counts& x);

} // namespace rubicon::report
