#include "io/process/line_socket.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace rubicon::io {

std::variant<line_socket, std::string> line_socket::connect(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path))
    return path + ": the path of a socket has at most " +
           std::to_string(sizeof(address.sun_path) - 1) + " octets";
  std::memcpy(&address.sun_path, path.data(), path.size());
  line_socket x(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (x.descriptor_ < 0 ||
      ::connect(x.descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0)
    return path + ": " + std::generic_category().message(errno);
  return x;
}

line_socket::line_socket(line_socket&& x) noexcept
    : descriptor_(std::exchange(x.descriptor_, -1)), received_(std::move(x.received_)) {}

line_socket::~line_socket() {
  if (descriptor_ >= 0)
    ::close(descriptor_);
}

std::optional<std::string> line_socket::read(std::size_t octets_max) {
  std::array<char, 1 << 16> piece;
  for (std::size_t searched = 0;;) {
    const auto end = received_.find('\n', searched);
    if (end != std::string::npos && end <= octets_max) {
      auto line = received_.substr(0, end);
      received_.erase(0, end + 1);
      return line;
    }
    searched = received_.size();
    if (searched > octets_max)
      return std::nullopt;
    const auto size = ::recv(descriptor_, piece.data(), piece.size(), 0);
    if (size < 0 && errno == EINTR)
      continue;
    if (size <= 0)
      return std::nullopt;
    received_.append(piece.data(), static_cast<std::size_t>(size));
  }
}

bool line_socket::write(std::string line) {
  line += '\n';
  for (std::string_view rest = line; !rest.empty();) {
    const auto size = ::send(descriptor_, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (size < 0 && errno == EINTR)
      continue;
    if (size < 0)
      return false;
    rest.remove_prefix(static_cast<std::size_t>(size));
  }
  return true;
}

bool line_socket::is_closed() const {
  pollfd x{descriptor_, POLLRDHUP, 0};
  return ::poll(&x, 1, 0) > 0 && (x.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

} // namespace rubicon::io
