// The mean of the newest counts of a transducer, wherever it is computed (PXY-17).
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace rubicon {

/// In whole numbers, so that a mote and a PC come to the same.
class running_mean {
public:
  /// @param size how many counts, at least 1. @pre their sum fits 64 bits
  explicit running_mean(std::size_t size = 1) : size_(size) { assert(size > 0); }

  /// @returns the mean of this and the `size` - 1 counts before it, of fewer as long as there are
  /// fewer; rounded, halves away from 0
  std::int64_t add(std::int64_t count) {
    counts_.push_back(count);
    sum_ += count;
    if (counts_.size() > size_) {
      sum_ -= counts_.front();
      counts_.pop_front();
    }
    const auto n = static_cast<std::int64_t>(counts_.size());
    return (2 * sum_ + (sum_ < 0 ? -n : n)) / (2 * n);
  }

private:
  std::size_t size_;
  std::deque<std::int64_t> counts_; ///< at most `size_`
  std::int64_t sum_ = 0;
};

} // namespace rubicon
