// What ends process groups when this process cannot do it any more.
#pragma once

#include <cstddef>

#include <sys/types.h>

namespace rubicon::io {

/// A small process beside this one, in a session of its own: when this process ends, however it
/// ends (a crash, SIGKILL), it kills the process groups that it was told of. A signal at the death
/// of a parent (PR_SET_PDEATHSIG) reaches children only; this reaches what they have started.
///
/// One for a process, made when it is first needed. Without it, because the system had no room for
/// another process, groups are killed by nobody: children end all the same.
class group_guard {
public:
  static constexpr std::size_t groups_max = 4096; ///< more are not guarded

  /// @returns that of this process; one that was forked without exec gets its own
  static group_guard& instance();

  ~group_guard(); ///< lets it end, and waits for that
  group_guard(const group_guard&) = delete;
  group_guard& operator=(const group_guard&) = delete;

  /// From the leader of a new group, before it runs a program: after fork() nothing else is needed.
  /// Safe after a fork of a process with threads.
  void add(pid_t group) const noexcept;

  /// Before the leader's end is collected: afterwards its number may be another's.
  void remove(pid_t group) const noexcept;

  [[nodiscard]] pid_t pid() const { return pid_; } ///< -1: there is none

private:
  group_guard();

  pid_t owner_;
  pid_t pid_ = -1;
  int to_ = -1; ///< closed by the kernel when this process ends
};

} // namespace rubicon::io
