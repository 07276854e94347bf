#include "testkit/report.hpp"

#include <algorithm>

#include "testkit/failure.hpp"

namespace rubicon::test {

bool has_logged(const std::vector<report::logged_event>& log, std::string_view who,
                std::string_view what) {
  return std::ranges::any_of(log, [&](const report::logged_event& line) {
    return line.who.ends_with(who) && line.what.starts_with(what);
  });
}

bool has_logged(const report::run_report& x, std::string_view who, std::string_view what) {
  return has_logged(x.event_log, who, what);
}

std::string told_violations(const report::run_report& x) {
  std::string all;
  for (const auto& each : x.violations)
    all += each.invariant + ": " + each.detail + '\n';
  return all;
}

const report::proxy_report& proxy_of(const report::run_report& x, std::string_view name) {
  const auto found = std::ranges::find(x.proxies, name, &report::proxy_report::name);
  if (found == x.proxies.end())
    throw failure("no proxy " + std::string(name));
  return *found;
}

std::string value(const report::proxy_report& x, std::string_view name) {
  const auto found = std::ranges::find(
      x.values, name, [](const auto& entry) { return std::string_view(entry.first); });
  return found == x.values.end() ? std::string() : found->second;
}

} // namespace rubicon::test
