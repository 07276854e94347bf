// A copy of this process that does one thing within limits, and can fail by itself.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include <sys/types.h>

#include "core/bytes.hpp"
#include "core/time.hpp"

namespace rubicon::io {

struct isolation_limits {
  duration processor = 1s; ///< between two calls of begin_call(); whole milliseconds
  duration wall = 30s;     ///< the same, for one that waits
  std::size_t memory = std::size_t{64} << 20; ///< octets that it may have more than this process
  std::size_t message_octets_max = 2048;
};

/// One end of a connection between the two, which keeps messages apart.
class isolated_end {
public:
  isolated_end(int socket, const isolation_limits& most) : socket_(socket), most_(most) {}
  isolated_end(const isolated_end&) = delete;
  isolated_end& operator=(const isolated_end&) = delete;
  ~isolated_end();

  /// @returns whether it was sent, and whether one came: the other end is gone otherwise
  [[nodiscard]] bool send(byte_view message) const;
  [[nodiscard]] bool receive(bytes& message) const;
  /// Waits for a message. @returns whether there is one, or the other end is gone
  [[nodiscard]] bool wait_until(std::chrono::steady_clock::time_point end) const;

private:
  int socket_;
  isolation_limits most_;
};

/// It has no open files but its end and the standard error, and none of our threads. It is killed
/// with this object, by the limit of its processor's time, and ends when this process does.
class isolated_process {
public:
  /// @param body runs in it, and may throw; the second argument begins its time anew
  /// @throws std::system_error if there is no room for it
  isolated_process(const isolation_limits& most,
                   const std::function<void(isolated_end&, const std::function<void()>&)>& body);
  ~isolated_process();
  isolated_process(const isolated_process&) = delete;
  isolated_process& operator=(const isolated_process&) = delete;

  void begin_call();
  void send(byte_view message);  ///< @throws std::runtime_error with the reason of its end
  [[nodiscard]] bytes receive(); ///< likewise

private:
  [[nodiscard]] int collect();
  [[noreturn]] void report_end();

  isolation_limits most_;
  pid_t pid_ = -1;
  std::unique_ptr<isolated_end> end_;
  std::chrono::steady_clock::time_point until_;
};

} // namespace rubicon::io
