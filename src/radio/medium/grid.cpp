#include "radio/medium/grid.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace rubicon::radio {

namespace {

/// What is farther out shares the outermost cells.
std::int32_t cell_number(double x_m, double edge_m) {
  constexpr double end = 1e9;
  return static_cast<std::int32_t>(std::clamp(std::floor(x_m / edge_m), -end, end));
}

} // namespace

void grid::insert(std::uint32_t x, const position& place) {
  cells_[around(place)].push_back(x);
}

void grid::erase(std::uint32_t x, const position& place) {
  const auto here = cells_.find(around(place));
  assert(here != cells_.end());
  auto& all = here->second;
  const auto found = std::find(all.begin(), all.end(), x);
  assert(found != all.end());
  *found = all.back();
  all.pop_back();
  if (all.empty())
    cells_.erase(here);
}

void grid::collect(const position& place, std::vector<std::uint32_t>& into) const {
  const auto middle = around(place);
  for (const int z : {-1, 0, 1}) {
    for (const int y : {-1, 0, 1}) {
      const cell first{middle[0] + z, middle[1] + y, middle[2] - 1};
      const cell last{first[0], first[1], middle[2] + 1};
      for (auto x = cells_.lower_bound(first); x != cells_.end() && x->first <= last; ++x)
        into.insert(into.end(), x->second.begin(), x->second.end());
    }
  }
}

grid::cell grid::around(const position& place) const {
  assert(std::isfinite(place.x_m) && std::isfinite(place.y_m) && std::isfinite(place.z_m));
  return {cell_number(place.z_m, edge_m_), cell_number(place.y_m, edge_m_),
          cell_number(place.x_m, edge_m_)};
}

} // namespace rubicon::radio
