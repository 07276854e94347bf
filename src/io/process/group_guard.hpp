// What ends process groups and removes folders when this process cannot do it any more.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include <sys/types.h>

namespace rubicon::io {

/// A small process beside this one, in a session of its own: when this process ends, however it
/// ends (a crash, SIGKILL), it kills the process groups and removes the folders that it was given.
/// A signal at the death of a parent (PR_SET_PDEATHSIG) reaches children only; this reaches what
/// they have started. If it is killed itself, another one takes its place.
///
/// One for a process, made when it is first needed. Without it, because the system had no room for
/// another process, groups are killed by nobody: children end all the same.
class group_guard {
public:
  static constexpr std::size_t groups_max = 4096; ///< more are not guarded
  static constexpr std::size_t folders_max = 16;  ///< likewise
  static constexpr std::size_t path_max = 255;    ///< [octets] of a folder; longer ones neither

  /// @returns that of this process; one that was forked without exec gets its own
  static group_guard& instance();

  ~group_guard(); ///< lets it end, and waits for that
  group_guard(const group_guard&) = delete;
  group_guard& operator=(const group_guard&) = delete;

  /// From the leader of a new group, before it runs a program: after fork() nothing else is needed.
  /// Safe after a fork of a process with threads.
  void add(pid_t group) const noexcept;

  /// From the parent of that leader, so that the next guard has it too.
  void keep(pid_t group);

  /// Before the leader's end is collected: afterwards its number may be another's.
  void remove(pid_t group);

  void add_folder(const std::string& path);
  void remove_folder(const std::string& path);

  [[nodiscard]] pid_t pid() const; ///< -1: there is none

private:
  group_guard();
  void start();
  void watch();

  pid_t owner_;
  mutable std::mutex lock_; ///< of all below
  std::condition_variable ends_;
  bool ending_ = false;
  pid_t pid_ = -1;
  int to_ = -1; ///< closed by the kernel when this process ends
  std::set<pid_t> groups_;
  std::set<std::string> folders_;
  std::thread watcher_;
};

} // namespace rubicon::io
