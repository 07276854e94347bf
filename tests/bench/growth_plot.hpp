// Curves of cost and memory over size, as a drawing.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

namespace bench {

/// One measurement; all figures above 0.
struct growth_point {
  double size = 0;
  double steps = 0;  ///< of the calibration loop: what it costs
  double octets = 0; ///< of memory
};

/// What grows by itself.
struct growth_panel {
  std::string title; ///< `Motes`
  std::string work;  ///< what the cost is of
  std::vector<growth_point> points;
};

/// The power of the size that `what` grows with: the line of least squares through the logarithms
/// of the last `count` points. Not a number if they have fewer than two sizes.
[[nodiscard]] double slope(const std::vector<growth_point>& points, double growth_point::*what,
                           std::size_t count);

/// Writes an SVG with a panel for each, log-log, and the slopes of all points and of the last two.
void draw_growth(std::ostream& out, const std::string& note,
                 const std::vector<growth_panel>& panels);

} // namespace bench
