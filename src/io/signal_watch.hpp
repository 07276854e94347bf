// SIGINT and SIGTERM as an event (ACT-11).
#pragma once

#include <functional>
#include <memory>

#include "io/loop.hpp"

namespace rubicon::io {

/// From construction to destruction the first SIGINT or SIGTERM calls a function once, on the
/// loop's thread, and gives both signals back their default action: a second one ends the process
/// even if the program does not come to an end by itself. At most one watch lives at a time.
class signal_watch {
public:
  /// Called with the signal's number. May destroy the watch.
  using callback = std::function<void(int signal)>;

  /// @param where must outlive the watch
  signal_watch(loop& where, callback on_signal);
  ~signal_watch();
  signal_watch(const signal_watch&) = delete;
  signal_watch& operator=(const signal_watch&) = delete;

private:
  struct state;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
