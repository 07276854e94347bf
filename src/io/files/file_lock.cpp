#include "io/files/file_lock.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace rubicon::io {

namespace {

std::string reason(int error) {
  return std::generic_category().message(error);
}

/// The number that the holder has written; empty if there is none.
std::string holder(int descriptor) {
  std::array<char, 16> text{};
  const auto size = ::pread(descriptor, text.data(), text.size(), 0);
  std::string digits(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  return digits.substr(0, digits.find_first_not_of("0123456789"));
}

} // namespace

std::variant<file_lock, std::string> file_lock::take(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (descriptor == -1)
    return path + " cannot be opened: " + reason(errno);
  file_lock lock(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK)
      return path + " cannot be locked: " + reason(errno);
    const auto who = holder(descriptor);
    return path + " is held by " +
           (who.empty() ? std::string("another process") : "process " + who);
  }
  const auto number = std::to_string(::getpid()) + '\n';
  if (::ftruncate(descriptor, 0) != 0 ||
      ::pwrite(descriptor, number.data(), number.size(), 0) != static_cast<ssize_t>(number.size()))
    return path + " cannot be written: " + reason(errno);
  return lock;
}

file_lock::~file_lock() {
  if (descriptor_ != -1)
    ::close(descriptor_);
}

file_lock::file_lock(file_lock&& x) noexcept : descriptor_(std::exchange(x.descriptor_, -1)) {}

std::string runtime_file(const std::string& name) {
  const auto* folder = std::getenv("XDG_RUNTIME_DIR");
  if (folder != nullptr && *folder != '\0')
    return std::string(folder) + '/' + name;
  return "/tmp/" + std::to_string(::getuid()) + '-' + name;
}

} // namespace rubicon::io
