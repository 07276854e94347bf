// A program that runs beside this one and whose output is read as it comes.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <sys/types.h>

namespace rubicon::cli {

/// How a child ended, and what it said.
struct child_end {
  int status = -1;       ///< exit status; -1 if a signal ended it
  int signal = 0;        ///< that signal, or 0
  std::string out;       ///< standard output
  std::string err;       ///< the last octets of standard error
  bool overlong = false; ///< it said more than `out_octets_max` and was killed for it
};

/// From construction until wait() a child runs, with an empty standard input and both outputs in
/// pipes. Destroying it kills the child. Whoever waits for several polls descriptors().
class child_process {
public:
  static constexpr std::size_t out_octets_max = std::size_t{64} << 20;
  static constexpr std::size_t err_octets_max = 4096;

  /// @param program its path
  /// @param words   what it finds as argv, its name first
  /// @throws std::system_error if it cannot be started
  child_process(const std::string& program, const std::vector<std::string>& words);
  ~child_process();
  child_process(child_process&& x) noexcept;
  child_process& operator=(child_process&&) = delete;

  /// Of the outputs that are still open; empty once the child has closed both.
  [[nodiscard]] std::vector<int> descriptors() const;

  /// Takes what is there; never waits.
  void read();

  /// It ends soon.
  void kill() const;

  /// Waits for its end. @pre not called before
  [[nodiscard]] child_end wait();

private:
  struct output {
    int descriptor = -1;
    std::string text;
  };

  /// False once there is nothing more to come.
  static bool read_block(output& from);
  static void close(output& x);

  pid_t pid_ = -1;
  output out_;
  output err_;
  bool overlong_ = false;
};

} // namespace rubicon::cli
