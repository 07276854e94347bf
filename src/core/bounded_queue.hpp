// The only queue a core may own: bounded, with a policy and a count of what it dropped.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace rubicon {

/// What a full queue gives up.
enum class overflow : std::uint8_t { drop_newest, drop_oldest };

/// First in, first out, at most `capacity` elements.
template <class T>
class bounded_queue {
public:
  explicit bounded_queue(std::size_t capacity = 0, overflow policy = overflow::drop_newest)
      : capacity_(capacity), policy_(policy) {}

  /// @returns false if `x` itself was dropped
  bool push(T x) {
    if (full()) {
      ++dropped_;
      if (policy_ == overflow::drop_newest || capacity_ == 0)
        return false;
      drop_front();
    }
    elements_.push_back(std::move(x));
    return true;
  }

  /// @pre !empty()
  [[nodiscard]] T& front() {
    assert(!empty());
    return elements_[first_];
  }

  /// @pre !empty()
  [[nodiscard]] const T& front() const {
    assert(!empty());
    return elements_[first_];
  }

  /// @pre !empty()
  T pop() {
    assert(!empty());
    T x = std::move(elements_[first_]);
    drop_front();
    return x;
  }

  void clear() {
    elements_.clear();
    first_ = 0;
  }

  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] bool full() const { return size() >= capacity_; }
  [[nodiscard]] std::size_t size() const { return elements_.size() - first_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

private:
  void drop_front() {
    if (++first_ * 2 < elements_.size())
      return;
    elements_.erase(elements_.begin(), elements_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
  }

  std::vector<T> elements_; ///< not a deque, which takes half a kilobyte even when empty
  std::size_t first_ = 0;   ///< those before it have been taken out
  std::size_t capacity_;
  overflow policy_;
  std::uint64_t dropped_ = 0;
};

} // namespace rubicon
