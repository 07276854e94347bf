// The event loop of the process: the one thread that waits for sockets, signals and the next
// timeout (docs/architecture.md, Time). Asio stays behind this header; io/context.hpp opens it for
// this room.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>

namespace rubicon::io {

/// Runs the callbacks of everything in this room, on the thread that calls poll() or wait_until().
/// All but wake() belongs to that one thread.
class loop {
public:
  using time_point = std::chrono::steady_clock::time_point;

  loop();
  ~loop();
  loop(const loop&) = delete;
  loop& operator=(const loop&) = delete;

  /// Runs callbacks that are ready, without waiting: at most 64, so that what they bring can be
  /// worked off before more comes.
  /// @returns how many ran
  std::size_t poll();

  /// Waits until a callback is ready, wake() is called or `until` has passed, then runs what is
  /// ready. A wake() that came before counts. May come back early, never without end. While
  /// callbacks follow each other within 50 us, or `until` is that near, it asks without sleeping.
  /// @returns how many callbacks ran
  std::size_t wait_until(time_point until);

  /// Ends the current wait_until(), or the next if there is none. From any thread, not from a
  /// handler of the C signal() kind.
  void wake();

  /// Calls `f` once, from the next poll() or wait_until(), with the callbacks that are ready.
  void post(std::function<void()> f);

  /// What the other files of this room work with.
  struct impl;
  [[nodiscard]] impl& inside() { return *impl_; }

private:
  std::unique_ptr<impl> impl_;
};

} // namespace rubicon::io
