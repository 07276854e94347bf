// For files of this room only: messages between the owner of a WebSocket and its thread.
#pragma once

#include <deque>
#include <functional>
#include <iterator>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/tcp/web_client.hpp"

namespace rubicon::io {

/// What both threads use.
class web_boxes {
public:
  explicit web_boxes(std::function<void()> wake) : wake_(std::move(wake)) {}

  // For the owner.

  /// @returns whether reading was paused for want of room
  bool take(std::vector<web_event>& to) {
    const std::lock_guard lock(mutex_);
    const bool paused = std::exchange(paused_, false);
    to.assign(std::make_move_iterator(inbox_.begin()), std::make_move_iterator(inbox_.end()));
    inbox_.clear();
    inbox_octets_ = 0;
    seen_life_ = life_;
    return paused;
  }

  /// @returns whether the client's thread has to look
  bool add(std::string text) {
    const std::lock_guard lock(mutex_);
    if (!is_connected_ || seen_life_ != life_) {
      ++counters_.not_sent;
      return false;
    }
    if (outbox_.size() >= web_client::outbox_max)
      overflowed_ = true;
    else
      outbox_.push_back(std::move(text));
    return outbox_.size() == 1 || overflowed_;
  }

  web_client_counters counters() const {
    const std::lock_guard lock(mutex_);
    return counters_;
  }

  // For the client's thread.

  void count_attempt() {
    const std::lock_guard lock(mutex_);
    ++counters_.attempts;
  }

  void begin_life() {
    const std::lock_guard lock(mutex_);
    ++life_;
    is_connected_ = true;
    report(web_connected{});
  }

  void end_life(std::string cause) {
    const std::lock_guard lock(mutex_);
    ++life_;
    is_connected_ = false;
    counters_.not_sent += outbox_.size();
    counters_.queue_full += std::exchange(overflowed_, false) ? 1 : 0;
    outbox_.clear();
    paused_ = false;
    report(web_disconnected{std::move(cause)});
  }

  /// @returns whether there is room for more; else take() says that reading was paused
  bool on_message(std::optional<std::string> text, bool is_text) {
    const std::lock_guard lock(mutex_);
    ++counters_.received;
    counters_.not_text += is_text ? 0 : 1;
    counters_.oversized += text ? 0 : 1;
    if (text && is_text) {
      inbox_octets_ += text->size();
      report(web_message{*std::move(text)});
    }
    paused_ =
        inbox_.size() >= web_client::inbox_max || inbox_octets_ >= web_client::inbox_octets_max;
    counters_.read_pauses += paused_ ? 1 : 0;
    return !paused_;
  }

  void on_sent() {
    const std::lock_guard lock(mutex_);
    ++counters_.sent;
    if (auto* last = inbox_.empty() ? nullptr : std::get_if<web_sent>(&inbox_.back()))
      ++last->count;
    else
      report(web_sent{1});
  }

  bool has_overflowed() const {
    const std::lock_guard lock(mutex_);
    return overflowed_;
  }

  std::optional<std::string> next_to_send() {
    const std::lock_guard lock(mutex_);
    if (outbox_.empty())
      return std::nullopt;
    std::optional<std::string> out(std::move(outbox_.front()));
    outbox_.pop_front();
    return out;
  }

private:
  /// @pre the mutex is held
  void report(web_event x) {
    inbox_.push_back(std::move(x));
    if (inbox_.size() == 1 && wake_)
      wake_();
  }

  mutable std::mutex mutex_;
  std::function<void()> wake_;
  bool is_connected_ = false;
  bool overflowed_ = false;
  bool paused_ = false;
  std::uint64_t life_ = 0;      ///< changes when a connection begins, and when it ends
  std::uint64_t seen_life_ = 0; ///< when take() was called last
  std::deque<std::string> outbox_;
  std::deque<web_event> inbox_;
  std::size_t inbox_octets_ = 0;
  web_client_counters counters_;
};

} // namespace rubicon::io
