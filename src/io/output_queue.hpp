// For files of this room only: what waits to leave through a socket.
#pragma once

#include <cstddef>
#include <deque>
#include <utility>

#include "core/bytes.hpp"

namespace rubicon::io {

/// Payloads in order, the first of which may have left in part. Its owner bounds it by size().
class output_queue {
public:
  void push(payload octets) {
    size_ += octets.size();
    waiting_.push_back(std::move(octets));
  }

  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  [[nodiscard]] std::size_t size() const { return size_; } ///< octets
  [[nodiscard]] std::size_t payloads() const { return waiting_.size(); }

  /// Whether a payload has left in part.
  [[nodiscard]] bool is_within_one() const { return gone_ > 0; }

  /// What is left of one. @pre index < payloads()
  [[nodiscard]] byte_view rest(std::size_t index = 0) const {
    return waiting_[index].view().subspan(index == 0 ? gone_ : 0);
  }

  /// So many octets have left. @pre octets <= size()
  void take(std::size_t octets) {
    size_ -= octets;
    gone_ += octets;
    while (!waiting_.empty() && gone_ >= waiting_.front().size()) {
      gone_ -= waiting_.front().size();
      waiting_.pop_front();
    }
  }

  void clear() {
    waiting_.clear();
    gone_ = 0;
    size_ = 0;
  }

private:
  std::deque<payload> waiting_;
  std::size_t gone_ = 0; ///< octets of the first
  std::size_t size_ = 0;
};

} // namespace rubicon::io
