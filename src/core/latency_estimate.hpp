// How long an answer is expected to take at most, from those before it.
#pragma once

#include <chrono>
#include <optional>

#include "core/time.hpp"

namespace rubicon {

/// Smoothed mean and four smoothed mean deviations, as RFC 6298 2 has them for retransmissions.
class latency_estimate {
public:
  void add(duration taken) {
    if (!mean_) {
      mean_ = taken;
      deviation_ = taken / 2;
      return;
    }
    deviation_ = (3 * deviation_ + std::chrono::abs(taken - *mean_)) / 4;
    mean_ = (7 * *mean_ + taken) / 8;
  }

  /// Nothing before the first answer.
  [[nodiscard]] std::optional<duration> bound() const {
    if (!mean_)
      return std::nullopt;
    return *mean_ + 4 * deviation_;
  }

private:
  std::optional<duration> mean_;
  duration deviation_{};
};

} // namespace rubicon
