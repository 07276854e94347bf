// First in, first out, without allocation once it has grown.
#pragma once

#include <cassert>
#include <cstddef>
#include <utility>
#include <vector>

namespace rubicon::parallel {

/// A ring whose size doubles when full. Each actor stands in it at most once, so it is bounded by
/// their number.
template <class T>
class ready_queue {
public:
  void push(T x) {
    if (size_ == ring_.size())
      grow();
    ring_[(first_ + size_) & (ring_.size() - 1)] = std::move(x);
    ++size_;
  }

  /// @pre !empty()
  T pop() {
    assert(size_ > 0);
    auto x = std::move(ring_[first_]);
    first_ = (first_ + 1) & (ring_.size() - 1);
    --size_;
    return x;
  }

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }

private:
  void grow() {
    std::vector<T> larger(ring_.empty() ? 64 : ring_.size() * 2);
    for (std::size_t i = 0; i < size_; ++i)
      larger[i] = std::move(ring_[(first_ + i) & (ring_.size() - 1)]);
    ring_ = std::move(larger);
    first_ = 0;
  }

  std::vector<T> ring_; ///< size is 0 or a power of two
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

} // namespace rubicon::parallel
