#include "report/print/repeated_violations.hpp"

#include <map>
#include <utility>

namespace rubicon::report {

std::vector<repeated_violation> repeated(const std::vector<violation>& all) {
  std::vector<repeated_violation> out;
  std::map<std::pair<std::string, std::string>, std::size_t> places;
  for (const auto& x : all) {
    const auto [place, is_new] = places.try_emplace({x.invariant, x.detail}, out.size());
    if (is_new) {
      out.push_back({x, x.at, 1});
      continue;
    }
    auto& same = out[place->second];
    ++same.count;
    same.last = x.at;
  }
  return out;
}

std::string detail_of(const repeated_violation& x) {
  if (x.count == 1)
    return x.first.detail;
  return x.first.detail + "; " + with_thousands(x.count) + " times, the last at " +
         run_time(x.last);
}

} // namespace rubicon::report
