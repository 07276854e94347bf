#include "io/process/machine.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <unistd.h>

namespace rubicon::io {

std::vector<network_interface> network_interfaces() {
  std::vector<network_interface> found;
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0)
    return found;
  for (const auto* x = first; x != nullptr; x = x->ifa_next) {
    if (x->ifa_addr == nullptr || x->ifa_addr->sa_family != AF_INET || (x->ifa_flags & IFF_UP) == 0)
      continue;
    sockaddr_in address{};
    std::memcpy(&address, x->ifa_addr, sizeof address);
    network_interface next{x->ifa_name, {}, (x->ifa_flags & IFF_LOOPBACK) != 0};
    std::memcpy(next.ipv4.data(), &address.sin_addr, next.ipv4.size());
    found.push_back(std::move(next));
  }
  ::freeifaddrs(first);
  return found;
}

bool has_address(const std::string& address) {
  std::array<std::uint8_t, 4> wanted{};
  if (::inet_pton(AF_INET, address.c_str(), wanted.data()) != 1)
    return false;
  if (wanted == std::array<std::uint8_t, 4>{} || wanted[0] == 127)
    return true;
  const auto all = network_interfaces();
  return std::any_of(all.begin(), all.end(), [&](const auto& x) { return x.ipv4 == wanted; });
}

std::string machine_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0)
    name.front() = '\0';
  const std::string whole(name.data());
  const auto label = whole.substr(0, whole.find('.'));
  return label.empty() ? "localhost" : label;
}

std::int64_t system_clock_us() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

std::int64_t time_since_boot_us() {
  timespec now{};
  static_cast<void>(::clock_gettime(CLOCK_BOOTTIME, &now));
  return std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1000;
}

std::size_t descriptors_max() {
  rlimit x{};
  return ::getrlimit(RLIMIT_NOFILE, &x) == 0 ? static_cast<std::size_t>(x.rlim_cur) : 0;
}

} // namespace rubicon::io
