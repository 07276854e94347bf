// A rate limiter for work that unauthenticated senders can cause.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/time.hpp"

namespace rubicon::smepp {

/// A token bucket: `burst` at once, and one more after each `pause`.
class rate_limiter {
public:
  rate_limiter() = default;
  rate_limiter(unsigned burst, duration pause) : burst_(burst), pause_(pause) {}

  /// @returns whether one more may be done now, and then counts it
  [[nodiscard]] bool take(instant now) {
    // When the last one that was granted has been worked off.
    const auto free_at = std::max(now, free_at_);
    if (free_at - now > pause_ * (static_cast<std::int64_t>(burst_) - 1)) {
      ++refused_;
      return false;
    }
    free_at_ = free_at + pause_;
    return true;
  }

  [[nodiscard]] std::uint64_t refused() const { return refused_; }

private:
  unsigned burst_ = 8;
  duration pause_ = 1s;
  instant free_at_;
  std::uint64_t refused_ = 0;
};

} // namespace rubicon::smepp
