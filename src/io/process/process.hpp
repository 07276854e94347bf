// A program that runs beside this one, as events of the loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include <sys/types.h>

#include "core/bytes.hpp"
#include "io/loop.hpp"
#include "io/process/spawn.hpp"

namespace rubicon::io {

/// How a process ended.
struct process_end {
  int status = -1; ///< exit status; -1 if a signal ended it
  int signal = 0;  ///< that signal, or 0

  friend bool operator==(const process_end&, const process_end&) = default;
};

/// `status 1`, `signal 9`
[[nodiscard]] std::string to_string(const process_end& x);

/// Runs from start() on, in a process group of its own, fed through a pipe. What it leaves running
/// in its group when it ends is killed. Destroying it kills all of it at once, and so does the end
/// of this process, even by SIGKILL. start() is for the main thread.
class process {
public:
  /// Input that waits until the process reads it; more is refused.
  static constexpr std::size_t waiting_octets_max = 65536;

  enum class output : std::uint8_t { out, err };

  struct callbacks {
    std::function<void(output from, byte_view octets)> on_output;
    /// Once, after all outputs. None of these is called any more, and the process may be destroyed.
    std::function<void(process_end how)> on_end;
  };

  /// @param where must outlive the process
  /// @returns the process, or why there is none
  [[nodiscard]] static std::variant<process, std::string> start(loop& where, spawn_request x,
                                                                callbacks f);
  ~process();
  process(process&& x) noexcept;
  process& operator=(process&& x) noexcept;

  /// @returns whether the text will be, or is, in the pipe
  [[nodiscard]] bool feed(std::string_view text);

  /// To all of its group; nothing happens once it has ended.
  void signal(int number) const;

  [[nodiscard]] pid_t pid() const;

private:
  struct state;
  explicit process(std::shared_ptr<state> x);

  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
