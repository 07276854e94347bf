// How far the time that peers share is ahead of an island's (CLK-08).
#pragma once

#include <optional>

#include "core/island_time.hpp"
#include "network/clock/clock_stamp.hpp"

namespace rubicon::network {

/// A line that was known at some time of the island, and holds from then on.
class network_offset {
public:
  network_offset() = default;
  network_offset(std::optional<network_line> line, island_time from) : line_(line), from_(from) {}

  /// The line as seen from then; nothing: none is known.
  [[nodiscard]] std::optional<network_line> at(island_time x) const;

private:
  std::optional<network_line> line_;
  island_time from_;
};

} // namespace rubicon::network
