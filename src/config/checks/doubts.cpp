#include "config/checks/doubts.hpp"

#include <algorithm>

namespace rubicon::config {

std::vector<problem> doubts_of(const loaded& x, const std::string& file_name) {
  auto out = x.doubts;
  doubt_list found;
  if (x.ecology) {
    doubt_proxies(*x.ecology, x.seen, found);
    doubt_tuples(*x.ecology, x.seen, found);
    doubt_messages(*x.ecology, x.seen, found);
    doubt_radios(*x.ecology, x.seen, found);
    doubt_traces(*x.ecology, x.seen, found);
  }
  complaints all;
  for (auto& [at, message] : found)
    all.doubt(at, std::move(message));
  std::ranges::move(with_settings(all.doubts_of(file_name), x.settings), std::back_inserter(out));
  std::ranges::stable_sort(out, {}, [](const problem& y) { return std::pair(y.line, y.column); });
  if (out.size() > doubts_max)
    out.resize(doubts_max);
  return out;
}

} // namespace rubicon::config
