// Things that are due at a time, earliest first; equal times by who has set them, and what one has
// set in the order it was set.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/time.hpp"

namespace rubicon::parallel {

/// The order of events: no scheduler decides it, so it is the same whoever runs them, and what
/// others do does not change the order of one's own.
struct event_order {
  instant due;
  std::uint64_t origin = 0;   ///< a number made of the path of the actor it comes from; 0: of none
  std::uint64_t sequence = 0; ///< ascending in what one process has set

  friend bool operator<(const event_order& a, const event_order& b) {
    if (a.due != b.due)
      return a.due < b.due;
    return a.origin != b.origin ? a.origin < b.origin : a.sequence < b.sequence;
  }
};

/// A heap that knows where each of its entries is, so that one can be moved or taken out: what is
/// pending is one entry, and nothing else takes memory.
/// @tparam T default-constructible and movable; T{} owns nothing
template <class T>
class timer_queue {
public:
  using ticket = std::uint32_t; ///< names an entry until it is popped or cancelled

  ticket add(const event_order& when, T x) {
    const auto slot = take_slot();
    values_[slot] = std::move(x);
    heap_.emplace_back();
    rise(heap_.size() - 1, {when, slot});
    return slot;
  }

  /// As if it were cancelled and added again. @pre `x` is pending
  void move(ticket x, const event_order& when) {
    assert(pending(x));
    sift(places_[x], {when, x});
  }

  /// @pre `x` is pending
  void cancel(ticket x) {
    assert(pending(x));
    const auto dying = std::exchange(values_[x], T{}); // may call back, so it dies last
    take_out(places_[x]);
  }

  [[nodiscard]] bool pending(ticket x) const { return x < places_.size() && places_[x] != nowhere; }

  /// When the first entry is due.
  [[nodiscard]] std::optional<instant> next() const {
    if (heap_.empty())
      return {};
    return heap_.front().when.due;
  }

  /// The entry that pop() will return. @pre next()
  [[nodiscard]] ticket front() const { return heap_.front().slot; }

  /// Takes the first entry. @pre next()
  T pop() {
    auto x = std::exchange(values_[front()], T{});
    take_out(0);
    if (heap_.empty() && heap_.capacity() > capacity_when_empty)
      release();
    return x;
  }

  [[nodiscard]] const T& operator[](ticket x) const { return values_[x]; }

  void clear() {
    // What dies may call back, so it dies after the queue has become empty.
    const auto dying = std::exchange(values_, {});
    heap_.clear();
    places_.clear();
    free_.clear();
  }

  [[nodiscard]] bool empty() const { return heap_.empty(); }
  [[nodiscard]] std::size_t size() const { return heap_.size(); }

private:
  using place = std::uint32_t; ///< index in the heap
  static constexpr place nowhere = UINT32_MAX;
  static constexpr std::size_t children = 4;
  /// A burst of more entries than this leaves no memory behind.
  static constexpr std::size_t capacity_when_empty = 1024;

  struct entry {
    event_order when;
    ticket slot = 0;
  };

  static bool before(const entry& a, const entry& b) { return a.when < b.when; }

  ticket take_slot() {
    if (free_.empty()) {
      values_.emplace_back();
      places_.push_back(nowhere);
      return static_cast<ticket>(values_.size() - 1);
    }
    const auto slot = free_.back();
    free_.pop_back();
    return slot;
  }

  void put(std::size_t i, const entry& x) {
    heap_[i] = x;
    places_[x.slot] = static_cast<place>(i);
  }

  /// Puts `x` at the free place `i` or above it.
  void rise(std::size_t i, entry x) {
    while (i > 0 && before(x, heap_[(i - 1) / children])) {
      put(i, heap_[(i - 1) / children]);
      i = (i - 1) / children;
    }
    put(i, x);
  }

  /// Puts `x` at the free place `i` or where it belongs above or below it.
  void sift(std::size_t i, entry x) {
    for (auto first = i * children + 1; first < heap_.size(); first = i * children + 1) {
      const auto from = heap_.begin() + static_cast<std::ptrdiff_t>(first);
      const auto end =
          heap_.begin() + static_cast<std::ptrdiff_t>(std::min(first + children, heap_.size()));
      const auto least = std::min_element(from, end, before);
      if (!before(*least, x))
        break;
      put(i, *least);
      i = static_cast<std::size_t>(least - heap_.begin());
    }
    rise(i, x);
  }

  void take_out(std::size_t i) {
    const auto slot = heap_[i].slot;
    const auto last = heap_.back();
    heap_.pop_back();
    if (i < heap_.size())
      sift(i, last);
    places_[slot] = nowhere;
    free_.push_back(slot);
  }

  void release() {
    heap_ = std::vector<entry>();
    values_ = std::vector<T>();
    places_ = std::vector<place>();
    free_ = std::vector<ticket>();
  }

  std::vector<entry> heap_;
  std::vector<T> values_;
  std::vector<place> places_; ///< of each value
  std::vector<ticket> free_;
};

} // namespace rubicon::parallel
