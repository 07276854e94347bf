// Finds what is near a place.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "core/address.hpp"

namespace rubicon::radio {

/// Numbers in cubic cells: whatever is within one edge of a place is in the 27 cells around it.
class grid {
public:
  /// @param edge_m above 0 and finite
  explicit grid(double edge_m = 1) : edge_m_(edge_m) {}

  [[nodiscard]] double edge_m() const { return edge_m_; }

  /// @pre the place is finite
  void insert(std::uint32_t x, const position& place);

  /// @pre `x` was inserted at this place
  void erase(std::uint32_t x, const position& place);

  /// Appends all that is within an edge of the place, and some more, in any order.
  void collect(const position& place, std::vector<std::uint32_t>& into) const;

private:
  using cell = std::array<std::int32_t, 3>; ///< z, y, x

  [[nodiscard]] cell around(const position& place) const;

  double edge_m_;
  std::map<cell, std::vector<std::uint32_t>> cells_;
};

} // namespace rubicon::radio
