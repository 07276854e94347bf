#include "network/clock/network_offset.hpp"

#include <cmath>

namespace rubicon::network {

std::optional<network_line> network_offset::at(island_time x) const {
  if (!line_)
    return std::nullopt;
  using us = std::chrono::microseconds;
  auto line = *line_;
  const auto since = static_cast<double>((x - from_).count());
  line.ahead += us(static_cast<us::rep>(std::floor(line.rate * since + 0.5)));
  return line;
}

} // namespace rubicon::network
