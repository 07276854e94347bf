// What is due when, for many radios at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/time.hpp"

namespace rubicon::radio {

enum class event_kind : std::uint8_t {
  mac_timer,   ///< subject: a radio
  ack_due,     ///< subject: a radio
  frame_end,   ///< subject: a slot of the medium
  battery_low, ///< subject: a radio
};

/// Nobody can cancel an event: `stamp` tells the owner whether it still means what it meant.
struct event {
  instant at;
  std::uint64_t stamp = 0;
  std::uint32_t subject = 0;
  event_kind kind = event_kind::mac_timer;
};

/// A binary heap; events of the same instant come out in the order in which they went in. Its owner
/// keeps it bounded: at most a few events a radio.
class event_queue {
public:
  void push(const event& x) {
    entries_.push_back({x, pushed_++});
    std::push_heap(entries_.begin(), entries_.end(), later);
  }

  /// @pre !empty()
  [[nodiscard]] const event& top() const { return entries_.front().content; }

  /// @pre !empty()
  void pop() {
    std::pop_heap(entries_.begin(), entries_.end(), later);
    entries_.pop_back();
  }

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

private:
  struct entry {
    event content;
    std::uint64_t order;
  };

  static bool later(const entry& a, const entry& b) {
    return a.content.at != b.content.at ? a.content.at > b.content.at : a.order > b.order;
  }

  std::vector<entry> entries_;
  std::uint64_t pushed_ = 0;
};

} // namespace rubicon::radio
