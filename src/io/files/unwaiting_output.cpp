#include "io/files/unwaiting_output.hpp"

#include <cerrno>
#include <chrono>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rubicon::io {

namespace {

bool may_keep_waiting(int descriptor) {
  struct stat about {};
  return ::fstat(descriptor, &about) == 0 && (S_ISCHR(about.st_mode) || S_ISFIFO(about.st_mode));
}

} // namespace

unwaiting_output::unwaiting_output(int descriptor) : descriptor_(descriptor) {
  if (!may_keep_waiting(descriptor))
    return;
  // Opened anew: that it does not block is nobody else's business.
  const auto path = "/proc/self/fd/" + std::to_string(descriptor);
  const auto own = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  is_own_ = own >= 0;
  if (is_own_)
    descriptor_ = own;
}

unwaiting_output::~unwaiting_output() {
  if (is_own_)
    ::close(descriptor_);
}

void unwaiting_output::write(std::string_view text) {
  write_some();
  if (buffer_.size() + text.size() > buffer_octets_max) {
    ++missed_;
    return;
  }
  buffer_ += text;
  write_some();
}

std::uint64_t unwaiting_output::missed() {
  write_some();
  return buffer_.empty() ? std::exchange(missed_, 0) : 0;
}

bool unwaiting_output::flush(duration patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  for (write_some(); !buffer_.empty(); write_some()) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    pollfd room{descriptor_, POLLOUT, 0};
    if (left.count() <= 0 || ::poll(&room, 1, static_cast<int>(left.count())) == 0)
      return false;
  }
  return true;
}

void unwaiting_output::write_some() {
  while (!buffer_.empty()) {
    const auto written = ::write(descriptor_, buffer_.data(), buffer_.size());
    if (written > 0)
      buffer_.erase(0, static_cast<std::size_t>(written));
    else if (written < 0 && errno == EINTR)
      continue;
    else if (written < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
      return;
    else
      buffer_.clear(); // nobody will ever read it
  }
}

} // namespace rubicon::io
