// SIGHUP as an event that comes again: "read your file anew".
#pragma once

#include <functional>
#include <memory>

#include "io/loop.hpp"

namespace rubicon::io {

/// From construction to destruction each SIGHUP calls a function, on the loop's thread; several at
/// once perhaps only once. @pre no signal_watch watches SIGHUP meanwhile
class hangup_watch {
public:
  /// @param where must outlive the watch
  hangup_watch(loop& where, std::function<void()> on_hangup);
  ~hangup_watch();
  hangup_watch(const hangup_watch&) = delete;
  hangup_watch& operator=(const hangup_watch&) = delete;

private:
  struct state;
  std::shared_ptr<state> state_;
};

/// Whether this process has a terminal, so that SIGHUP says that it was closed.
[[nodiscard]] bool has_terminal();

} // namespace rubicon::io
