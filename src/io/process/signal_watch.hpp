// SIGINT, SIGTERM and SIGHUP as an event (ACT-11).
#pragma once

#include <functional>
#include <memory>

#include "io/loop.hpp"

namespace rubicon::io {

/// From construction to destruction the first SIGINT, SIGTERM or SIGHUP calls a function once, on
/// the loop's thread, and gives the first two back their default action: a second one ends the
/// process even if the program does not come to an end by itself. SIGHUP is ignored from then on: a
/// terminal that goes away sends it more than once, and systemd may send it right after SIGTERM. It
/// is not watched if it was ignored before (nohup). At most one watch lives at a time.
class signal_watch {
public:
  /// Called with the signal's number. May destroy the watch.
  using callback = std::function<void(int signal)>;

  /// @param where must outlive the watch
  /// @param hangup_too false: SIGHUP is not watched
  signal_watch(loop& where, callback on_signal, bool hangup_too = true);
  ~signal_watch();
  signal_watch(const signal_watch&) = delete;
  signal_watch& operator=(const signal_watch&) = delete;

private:
  struct state;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
