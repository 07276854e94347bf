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

  /// Both: nothing before the first answer.
  [[nodiscard]] std::optional<duration> mean() const { return mean_; }
  [[nodiscard]] std::optional<duration> bound() const {
    if (!mean_)
      return std::nullopt;
    return *mean_ + 4 * deviation_;
  }

  /// Whether a bound is to be published in the place of another: where it has grown, or has fallen
  /// to less than half.
  [[nodiscard]] static bool replaces(duration bound, std::optional<duration> published) {
    return !published || bound > *published || 2 * bound < *published;
  }

private:
  std::optional<duration> mean_;
  duration deviation_{};
};

} // namespace rubicon
