// A file that one process at a time may hold.
#pragma once

#include <string>
#include <variant>

namespace rubicon::io {

/// Holds a lock on a file from take() on until it is destroyed or the process ends, however that
/// happens. The file says who holds it, and stays.
class file_lock {
public:
  /// @returns the lock, or why there is none: `PATH is held by process 4711`
  [[nodiscard]] static std::variant<file_lock, std::string> take(const std::string& path);

  ~file_lock();
  file_lock(file_lock&& x) noexcept;
  file_lock& operator=(file_lock&&) = delete;

private:
  explicit file_lock(int descriptor) : descriptor_(descriptor) {}

  int descriptor_ = -1;
};

/// The path of such a file of this user: in XDG_RUNTIME_DIR, or else in /tmp.
[[nodiscard]] std::string runtime_file(const std::string& name);

} // namespace rubicon::io
