// The only queue a core may own: bounded, with a policy and a count of what it dropped.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>

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
    if (elements_.size() >= capacity_) {
      ++dropped_;
      if (policy_ == overflow::drop_newest || capacity_ == 0)
        return false;
      elements_.pop_front();
    }
    elements_.push_back(std::move(x));
    return true;
  }

  /// @pre !empty()
  [[nodiscard]] T& front() {
    assert(!elements_.empty());
    return elements_.front();
  }

  /// @pre !empty()
  T pop() {
    assert(!elements_.empty());
    T x = std::move(elements_.front());
    elements_.pop_front();
    return x;
  }

  void clear() { elements_.clear(); }

  [[nodiscard]] bool empty() const { return elements_.empty(); }
  [[nodiscard]] bool full() const { return elements_.size() >= capacity_; }
  [[nodiscard]] std::size_t size() const { return elements_.size(); }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

private:
  std::deque<T> elements_;
  std::size_t capacity_;
  overflow policy_;
  std::uint64_t dropped_ = 0;
};

} // namespace rubicon
