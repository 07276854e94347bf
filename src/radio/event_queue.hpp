// What is due when, for many radios at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/time.hpp"

namespace rubicon::radio {

enum class event_kind : std::uint8_t {
  mac_timer,   ///< subject: a radio
  ack_due,     ///< subject: a radio
  frame_end,   ///< subject: a slot of the medium
  battery_low, ///< subject: a radio
  listening,   ///< subject: a radio
};

/// An event cannot be cancelled: by `stamp` its owner recognises one that is out of date.
struct event {
  instant at{};
  instant output_at{}; ///< nothing that it leads to is output before; not before `at`
  std::uint64_t stamp = 0;
  std::uint32_t subject = 0;
  event_kind kind = event_kind::mac_timer;
};

/// A binary heap; events of the same instant come out in the order in which they went in. Its owner
/// keeps it bounded: at most a few events a radio. Beside it a heap of when events may have an
/// output.
class event_queue {
public:
  void push(const event& x) {
    if (sure_ && x.at <= sure_->at)
      doubt();
    push_silent(x);
    expect_output(x);
  }

  /// An event that will have its output no earlier than `hopeful` says, unless another comes before
  /// it: then it is as `cautious` says. The two differ in output_at alone.
  void push_sure(const event& hopeful, const event& cautious) {
    push(hopeful);
    sure_ = cautious;
  }

  /// The last sure event may turn out otherwise.
  void doubt() {
    if (sure_)
      expect_output(*std::exchange(sure_, std::nullopt));
  }

  /// Of an event without any output: next_output() does not count it.
  void push_silent(const event& x) {
    entries_.push_back({x, pushed_++});
    std::push_heap(entries_.begin(), entries_.end(), later);
  }

  /// The earliest output_at among events that are still to come.
  /// @param is_current whether an event is not out of date
  /// @param done events until here have been handled
  template <class IsCurrent>
  [[nodiscard]] std::optional<instant> next_output(instant done, IsCurrent is_current) {
    while (!by_output_.empty()) {
      const auto& x = by_output_.front();
      if (x.at > done && is_current(x))
        return x.output_at;
      std::pop_heap(by_output_.begin(), by_output_.end(), output_later);
      by_output_.pop_back();
    }
    return std::nullopt;
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
  void expect_output(const event& x) {
    by_output_.push_back(x);
    std::push_heap(by_output_.begin(), by_output_.end(), output_later);
  }

  struct entry {
    event content;
    std::uint64_t order;
  };

  // No functions: calls by pointer are not inlined into the heaps' loops.
  static constexpr auto later = [](const entry& a, const entry& b) {
    return a.content.at != b.content.at ? a.content.at > b.content.at : a.order > b.order;
  };
  static constexpr auto output_later = [](const event& a, const event& b) {
    return a.output_at > b.output_at;
  };

  std::vector<entry> entries_;
  std::vector<event> by_output_;
  std::optional<event> sure_; ///< with the moment from which it may have an output if it is not
  std::uint64_t pushed_ = 0;
};

} // namespace rubicon::radio
