// Things that are due at a time, earliest first, equal times in the order they were added.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/time.hpp"

namespace rubicon::scheduler {

/// A binary heap over slots. What is cancelled is destroyed at once; its entry in the heap stays
/// until it is reached, or until cancelled entries are the majority, when the heap is rebuilt. So
/// memory is proportional to the largest number ever pending at one time.
/// @tparam T default-constructible and movable; T{} owns nothing
template <class T>
class timer_queue {
public:
  using ticket = std::uint32_t; ///< names an entry until it is popped or cancelled

  ticket add(instant due, T x) {
    const auto slot = take_slot();
    slots_[slot].value = std::move(x);
    slots_[slot].live = true;
    heap_.push_back({due, sequence_++, slot});
    std::push_heap(heap_.begin(), heap_.end(), later);
    ++live_;
    return slot;
  }

  /// @pre `x` is pending
  void cancel(ticket x) {
    assert(slots_[x].live);
    slots_[x].live = false;
    --live_;
    auto dying = std::exchange(slots_[x].value, T{});
    if (heap_.size() > 2 * live_ + 64)
      rebuild();
  }

  /// When the first entry is due.
  [[nodiscard]] std::optional<instant> next() {
    while (!heap_.empty() && !slots_[heap_.front().slot].live)
      drop_front();
    if (heap_.empty())
      return {};
    return heap_.front().due;
  }

  /// The entry that pop() will return. @pre next()
  [[nodiscard]] ticket front() const { return heap_.front().slot; }

  /// Takes the first entry. @pre next()
  T pop() {
    auto& slot = slots_[heap_.front().slot];
    assert(slot.live);
    slot.live = false;
    --live_;
    auto x = std::exchange(slot.value, T{});
    drop_front();
    return x;
  }

  [[nodiscard]] const T& operator[](ticket x) const { return slots_[x].value; }

  void clear() {
    // What dies may call back, so it dies after the queue has become empty.
    auto dying = std::exchange(slots_, {});
    heap_.clear();
    free_.clear();
    live_ = 0;
  }

  [[nodiscard]] bool empty() const { return live_ == 0; }
  [[nodiscard]] std::size_t size() const { return live_; }

  /// Entries held in memory, cancelled ones included.
  [[nodiscard]] std::size_t footprint() const { return heap_.size(); }

private:
  struct entry {
    instant due;
    std::uint64_t sequence;
    ticket slot;
  };

  struct slot_type {
    T value;
    bool live = false;
  };

  static bool later(const entry& a, const entry& b) {
    return a.due != b.due ? a.due > b.due : a.sequence > b.sequence;
  }

  ticket take_slot() {
    if (free_.empty()) {
      slots_.emplace_back();
      return static_cast<ticket>(slots_.size() - 1);
    }
    const auto slot = free_.back();
    free_.pop_back();
    return slot;
  }

  void drop_front() {
    free_.push_back(heap_.front().slot);
    std::pop_heap(heap_.begin(), heap_.end(), later);
    heap_.pop_back();
  }

  void rebuild() {
    std::erase_if(heap_, [this](const entry& x) {
      if (slots_[x.slot].live)
        return false;
      free_.push_back(x.slot);
      return true;
    });
    std::make_heap(heap_.begin(), heap_.end(), later);
  }

  std::vector<entry> heap_;
  std::vector<slot_type> slots_;
  std::vector<ticket> free_;
  std::uint64_t sequence_ = 0;
  std::size_t live_ = 0;
};

} // namespace rubicon::scheduler
