#include "testkit/report.hpp"

#include <algorithm>

#include "testkit/failure.hpp"

namespace rubicon::test {

bool tells(const std::vector<runtime::story_line>& story, std::string_view who,
           std::string_view what) {
  return std::ranges::any_of(story, [&](const runtime::story_line& line) {
    return line.who.ends_with(who) && line.what.starts_with(what);
  });
}

bool tells(const runtime::report& x, std::string_view who, std::string_view what) {
  return tells(x.story, who, what);
}

std::string told_violations(const runtime::report& x) {
  std::string all;
  for (const auto& each : x.violations)
    all += each.invariant + ": " + each.detail + '\n';
  return all;
}

const runtime::proxy_report& proxy_of(const runtime::report& x, std::string_view name) {
  const auto found = std::ranges::find(x.proxies, name, &runtime::proxy_report::name);
  if (found == x.proxies.end())
    throw failure("no proxy " + std::string(name));
  return *found;
}

std::string value(const runtime::proxy_report& x, std::string_view name) {
  const auto found = std::ranges::find(
      x.values, name, [](const auto& entry) { return std::string_view(entry.first); });
  return found == x.values.end() ? std::string() : found->second;
}

} // namespace rubicon::test
