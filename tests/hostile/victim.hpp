// The process under attack, seen from outside: is it alive, and how much memory does it take?
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include <sys/types.h>

namespace rubicon::hostile {

/// Resident octets of a process, as /proc tells (proc(5), VmRSS); 0 if there is none, or a zombie.
[[nodiscard]] std::uint64_t resident_octets(pid_t process);

/// Samples a process's memory on a thread of its own.
class memory_watch {
public:
  explicit memory_watch(pid_t process);
  ~memory_watch();
  memory_watch(const memory_watch&) = delete;
  memory_watch& operator=(const memory_watch&) = delete;

  [[nodiscard]] std::uint64_t now() const { return now_; }
  /// The most since the last call.
  [[nodiscard]] std::uint64_t take_peak() { return peak_.exchange(now_); }
  [[nodiscard]] bool alive() const { return now_ > 0; }

private:
  void run();

  pid_t process_;
  std::atomic<std::uint64_t> now_ = 0;
  std::atomic<std::uint64_t> peak_ = 0;
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

} // namespace rubicon::hostile
