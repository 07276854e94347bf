// What other threads ask of the scheduler, until its own thread takes it over.
#pragma once

#include <atomic>
#include <mutex>
#include <thread>
#include <variant>
#include <vector>

#include <caf/resumable.hpp>

#include "scheduler/timeout.hpp"

namespace rubicon::io {
class loop;
}

namespace rubicon::scheduler {

/// An actor of CAF's own that is ready, with one reference count; or a message for one of ours.
using order = std::variant<caf::resumable*, add_timeout>;

/// The queue of orders from other threads, in the order they came. Each arrival ends the loop's
/// wait.
class outside {
public:
  /// The thread that constructs it is home.
  explicit outside(io::loop* loop) : home_(std::this_thread::get_id()), loop_(loop) {}

  [[nodiscard]] bool at_home() const { return std::this_thread::get_id() == home_; }

  void post(order x);

  /// Ends the loop's wait, if there is a loop.
  void wake();

  /// Whether take() would return something; may be late by an instant.
  [[nodiscard]] bool waiting() const { return waiting_.load(std::memory_order_relaxed); }

  [[nodiscard]] std::vector<order> take();

  /// No wake() reaches the loop after this.
  void detach();

private:
  const std::thread::id home_;
  std::mutex mutex_; ///< guards what follows, except reading waiting_
  io::loop* loop_;
  std::vector<order> orders_;
  std::atomic<bool> waiting_ = false;
};

} // namespace rubicon::scheduler
