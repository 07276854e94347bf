// A file of its own, since the kernel's <linux/tcp.h> excludes the C library's <netinet/tcp.h>.
#include "io/tcp/tcp_window.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

namespace rubicon::io {

std::size_t unacknowledged(int socket) {
  int octets = 0;
  return ::ioctl(socket, SIOCOUTQ, &octets) == 0 ? static_cast<std::size_t>(std::max(octets, 0))
                                                 : 0;
}

std::size_t window_of_other_side(int socket) {
  tcp_info info{};
  socklen_t size = sizeof info;
  const bool known = ::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 &&
                     size >= offsetof(tcp_info, tcpi_snd_wnd) + sizeof info.tcpi_snd_wnd;
  return known ? info.tcpi_snd_wnd : SIZE_MAX;
}

} // namespace rubicon::io
