// How many messages a bridge reads in a second.
#pragma once

#include <cstddef>

#include "core/time.hpp"

namespace rubicon::bridge {

/// Counts from zero again once a second has passed since the first that was counted.
class per_second_limit {
public:
  explicit per_second_limit(std::size_t most) : most_(most) {}

  /// When it counts from zero again.
  [[nodiscard]] instant next() const { return begins_ + 1s; }

  /// Another message has come. @returns whether it is within the limit
  [[nodiscard]] bool accepts(instant now) {
    if (now >= begins_ + 1s) {
      begins_ = now;
      count_ = 0;
    }
    return count_ < most_ && ++count_ > 0;
  }

private:
  std::size_t most_;
  instant begins_{};
  std::size_t count_ = 0;
};

} // namespace rubicon::bridge
