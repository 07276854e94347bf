#include "config/checks/warnings.hpp"

#include <algorithm>

namespace rubicon::config {

std::vector<problem> warnings_of(const loaded& x, const std::string& file_name) {
  auto out = x.warnings;
  warning_list found;
  if (x.ecology) {
    warn_of_proxies(*x.ecology, x.seen, found);
    warn_of_tuples(*x.ecology, x.seen, found);
    warn_of_messages(*x.ecology, x.seen, found);
    warn_of_streams(*x.ecology, x.seen, found);
    warn_of_radios(*x.ecology, x.seen, found);
    warn_of_traces(*x.ecology, x.seen, found);
  }
  complaints all;
  for (auto& [at, message] : found)
    all.warn(at, std::move(message));
  std::ranges::move(with_settings(all.warnings_of(file_name), x.settings), std::back_inserter(out));
  std::ranges::stable_sort(out, {}, [](const problem& y) { return std::pair(y.line, y.column); });
  if (out.size() > warnings_max)
    out.resize(warnings_max);
  return out;
}

} // namespace rubicon::config
