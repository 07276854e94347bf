// "Call me after so long", on the loop's thread.
#pragma once

#include <functional>
#include <memory>

#include "core/time.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

/// One call at a time is due; destroying the timer takes it back.
class timer {
public:
  /// @param where must outlive the timer
  explicit timer(loop& where);
  ~timer();
  timer(timer&&) noexcept;
  timer& operator=(timer&&) = delete;

  /// Calls `f` once, and never what was due before. It may destroy the timer.
  void start(duration length, std::function<void()> f);
  void stop();

private:
  struct state;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
