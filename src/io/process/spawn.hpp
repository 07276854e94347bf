// Starting a program beside this one, its inputs and outputs in pipes.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace rubicon::io {

struct spawn_request {
  std::string program;                       ///< its path
  std::vector<std::string> words;            ///< what it finds as argv, its name first
  std::vector<std::string> environment = {}; ///< `NAME=value`, besides what this process has
  std::string folder = {};                   ///< in which it begins; empty: ours
  bool feeds = false; ///< its standard input is a pipe; else it is empty from the beginning
  /// Signals may be sent to it and all that it starts, as -pid. It is guarded
  /// (io/process/group_guard.hpp): whoever collects its end says so there first.
  bool own_group = false;
};

/// Our ends of the pipes, which never wait and are not inherited by other children. Whoever gets
/// one closes the pipes and waits for the process.
struct spawned {
  pid_t pid = -1;
  int in = -1; ///< -1: it is not fed
  int out = -1;
  int err = -1;
};

/// The program is killed when the thread that called this ends, however it ends: so call it from
/// the main thread.
/// @throws std::system_error if it cannot be started
[[nodiscard]] spawned spawn(const spawn_request& x);

} // namespace rubicon::io
