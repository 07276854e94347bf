#include "io/files/replace_file.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace rubicon::io {

namespace {

bool write_all(int to, std::string_view content) {
  while (!content.empty()) {
    const auto count = ::write(to, content.data(), content.size());
    if (count == -1 && errno == EINTR)
      continue;
    if (count == -1)
      return false;
    content.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

bool write_new(const std::string& path, std::string_view content, durability how) {
  const int to = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (to == -1)
    return false;
  const bool good = write_all(to, content) && (how == durability::of_process || ::fsync(to) == 0);
  const int error = errno;
  const bool closed = ::close(to) == 0;
  if (!good)
    errno = error;
  return good && closed;
}

} // namespace

std::string replace_file(const std::string& path, std::string_view content, durability how) {
  const auto next = path + ".new";
  if (write_new(next, content, how) && std::rename(next.c_str(), path.c_str()) == 0)
    return {};
  return path + " cannot be written: " + std::generic_category().message(errno);
}

} // namespace rubicon::io
