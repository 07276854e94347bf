#include "config/checks/connectivity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/numbers/math.hpp"

namespace rubicon::config {

namespace {

/// Cubes of the size of the range: who is near a place is in its cube or in one around it.
using cube = std::array<std::int64_t, 3>;

cube cube_of(const position& x, double side) {
  return {static_cast<std::int64_t>(std::floor(x.x_m / side)),
          static_cast<std::int64_t>(std::floor(x.y_m / side)),
          static_cast<std::int64_t>(std::floor(x.z_m / side))};
}

class waiting_places {
public:
  waiting_places(const std::vector<position>& places, double range_m)
      : places_(places), range_m_(range_m) {
    for (std::size_t i = 0; i < places.size(); ++i)
      cubes_[cube_of(places[i], range_m)].push_back(i);
  }

  /// Takes out those within range of `x`.
  void take_near(const position& x, std::vector<std::size_t>& taken) {
    const auto middle = cube_of(x, range_m_);
    for (std::int64_t i = 0; i < 27; ++i) {
      const auto found =
          cubes_.find({middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1});
      if (found == cubes_.end())
        continue;
      std::erase_if(found->second, [&](std::size_t each) {
        const auto& y = places_[each];
        if (math::length(x.x_m - y.x_m, x.y_m - y.y_m, x.z_m - y.z_m) > range_m_)
          return false;
        taken.push_back(each);
        return true;
      });
    }
  }

  [[nodiscard]] std::vector<std::size_t> left() const {
    std::vector<std::size_t> all;
    for (const auto& [where, each] : cubes_)
      all.insert(all.end(), each.begin(), each.end());
    std::sort(all.begin(), all.end());
    return all;
  }

private:
  const std::vector<position>& places_;
  double range_m_;
  std::map<cube, std::vector<std::size_t>> cubes_;
};

} // namespace

std::vector<std::size_t> disconnected_from(const position& from,
                                           const std::vector<position>& places, double range_m) {
  return disconnected_from_any({from}, places, range_m);
}

std::vector<std::size_t> disconnected_from_any(const std::vector<position>& from,
                                               const std::vector<position>& places,
                                               double range_m) {
  waiting_places waiting(places, range_m);
  std::vector<std::size_t> reached;
  for (const auto& each : from)
    waiting.take_near(each, reached);
  for (std::size_t i = 0; i < reached.size(); ++i)
    waiting.take_near(places[reached[i]], reached);
  return waiting.left();
}

std::vector<unsigned> hops_from(const std::vector<position>& places, std::size_t from,
                                double range_m) {
  waiting_places waiting(places, range_m);
  std::vector<unsigned> hops(places.size());
  std::vector<std::size_t> reached;
  const auto go_on = [&](std::size_t at, unsigned steps) {
    const auto before = reached.size();
    waiting.take_near(places[at], reached);
    for (auto i = before; i < reached.size(); ++i)
      hops[reached[i]] = steps;
  };
  go_on(from, 1);
  for (std::size_t i = 0; i < reached.size(); ++i)
    go_on(reached[i], reached[i] == from ? 1 : hops[reached[i]] + 1);
  hops[from] = 0;
  return hops;
}

} // namespace rubicon::config
