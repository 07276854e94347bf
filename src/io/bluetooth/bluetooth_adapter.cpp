#include "io/bluetooth/bluetooth_adapter.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>

#include <sys/ioctl.h>
#include <sys/socket.h>

namespace rubicon::io {

namespace {

std::string cannot_open(const std::string& name) {
  return "cannot open Bluetooth adapter " + name + ": ";
}

std::error_code last_error() {
  return {errno, std::system_category()};
}

} // namespace

std::string why_no_adapter(const std::string& name, const std::error_code& error) {
  const auto is = [&error](std::errc x) { return error == std::make_error_condition(x); };
  if (is(std::errc::address_family_not_supported) || is(std::errc::protocol_not_supported))
    return cannot_open(name) + "this system has no Bluetooth (" + error.message() + ')';
  if (is(std::errc::no_such_device))
    return cannot_open(name) + "no such device";
  if (is(std::errc::network_down))
    return cannot_open(name) + "it is switched off; run `bluetoothctl power on`";
  return cannot_open(name) + error.message();
}

std::vector<std::string> bluetooth_adapters() {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& each : std::filesystem::directory_iterator("/sys/class/bluetooth", none)) {
    auto name = each.path().filename().string();
    if (name.find(':') == std::string::npos) // `hci0:12` is a connection
      names.push_back(std::move(name));
  }
  std::ranges::sort(names);
  return names;
}

#if defined(__linux__) && defined(AF_BLUETOOTH)

namespace {

// What the kernel's interface has (Linux, net/bluetooth: bluetooth.h, hci_sock.h, l2cap.h), which
// no header of the C library declares. Addresses are in reverse order there, numbers of L2CAP
// little-endian.
constexpr int protocol_l2cap = 0;
constexpr int protocol_hci = 1;
constexpr int level_hci = 0;
constexpr int level_l2cap = 6;
constexpr int option_hci_filter = 2;
constexpr int option_l2cap_options = 1;
constexpr unsigned long get_device_info = _IOR('H', 211, int); // HCIGETDEVINFO
constexpr std::uint32_t device_is_up = 1;                      // bit 0 of flags, HCI_UP
constexpr std::uint32_t event_packets = 1U << 4;               // HCI_EVENT_PKT

struct l2cap_address {
  sa_family_t family;
  std::uint16_t port;
  std::array<std::uint8_t, 6> device;
  std::uint16_t channel;
  std::uint8_t device_type; ///< 0: BR/EDR
};
static_assert(sizeof(l2cap_address) == 14);

struct hci_address {
  sa_family_t family;
  std::uint16_t device;
  std::uint16_t channel; ///< 0: raw
};
static_assert(sizeof(hci_address) == 6);

struct hci_filter {
  std::uint32_t types;
  std::array<std::uint32_t, 2> events;
  std::uint16_t opcode;
};
static_assert(sizeof(hci_filter) == 16);

struct hci_device_info {
  std::uint16_t device;
  std::array<char, 8> name;
  std::array<std::uint8_t, 6> address;
  std::uint32_t flags;
  std::uint8_t type;
  std::array<std::uint8_t, 8> features;
  std::uint32_t packet_type;
  std::uint32_t link_policy;
  std::uint32_t link_mode;
  std::array<std::uint16_t, 4> buffers;
  std::array<std::uint32_t, 10> statistics;
};
static_assert(sizeof(hci_device_info) == 92);

struct l2cap_options {
  std::uint16_t output_mtu;
  std::uint16_t input_mtu;
  std::uint16_t flush_timeout;
  std::uint8_t mode;
  std::uint8_t checksum;
  std::uint8_t transmissions_max;
  std::uint16_t window;
};
static_assert(sizeof(l2cap_options) == 12);

constexpr std::uint16_t mtu = 2048; ///< a full package takes 1064 octets, the default is 672
constexpr int backlog = 8;
constexpr int not_blocking = SOCK_CLOEXEC | SOCK_NONBLOCK;

bluetooth_octets reversed(bluetooth_octets x) {
  std::reverse(x.begin(), x.end());
  return x;
}

std::uint16_t little_endian(std::uint16_t x) {
  const std::array<std::uint8_t, 2> octets{static_cast<std::uint8_t>(x),
                                           static_cast<std::uint8_t>(x >> 8)};
  std::memcpy(&x, octets.data(), sizeof x);
  return x;
}

l2cap_address l2cap_address_of(const bluetooth_octets& device, std::uint16_t port) {
  l2cap_address x{};
  x.family = AF_BLUETOOTH;
  x.port = little_endian(port);
  x.device = reversed(device);
  return x;
}

template <class Address>
const sockaddr* plain(const Address& x) {
  return reinterpret_cast<const sockaddr*>(&x);
}

/// Without it the connection still works, in smaller packets.
void widen(int socket) {
  l2cap_options x{};
  socklen_t size = sizeof x;
  if (::getsockopt(socket, level_l2cap, option_l2cap_options, &x, &size) != 0)
    return;
  x.input_mtu = mtu;
  static_cast<void>(::setsockopt(socket, level_l2cap, option_l2cap_options, &x, sizeof x));
}

class kernel_adapter : public bluetooth_adapter {
public:
  kernel_adapter(std::uint16_t number, const bluetooth_octets& address)
      : number_(number), address_(address) {}

  [[nodiscard]] bluetooth_octets address() const override { return address_; }

  [[nodiscard]] opened listen(std::uint16_t port) override {
    descriptor x(::socket(AF_BLUETOOTH, SOCK_SEQPACKET | not_blocking, protocol_l2cap));
    const auto here = l2cap_address_of(address_, port);
    if (x.get() == -1 || ::bind(x.get(), plain(here), sizeof here) != 0)
      return last_error();
    widen(x.get());
    if (::listen(x.get(), backlog) != 0)
      return last_error();
    return x;
  }

  [[nodiscard]] opened connect(const bluetooth_octets& to, std::uint16_t port) override {
    descriptor x(::socket(AF_BLUETOOTH, SOCK_SEQPACKET | not_blocking, protocol_l2cap));
    const auto here = l2cap_address_of(address_, 0);
    if (x.get() == -1 || ::bind(x.get(), plain(here), sizeof here) != 0)
      return last_error();
    widen(x.get());
    const auto there = l2cap_address_of(to, port);
    if (::connect(x.get(), plain(there), sizeof there) != 0 && errno != EINPROGRESS)
      return last_error();
    return x;
  }

  [[nodiscard]] opened open_controller() override {
    descriptor x(::socket(AF_BLUETOOTH, SOCK_RAW | not_blocking, protocol_hci));
    const hci_address here{AF_BLUETOOTH, number_, 0};
    // Without privileges the kernel lets the inquiry's command and events pass.
    const hci_filter events{event_packets, {0xffffffff, 0xffffffff}, 0};
    if (x.get() == -1 ||
        ::setsockopt(x.get(), level_hci, option_hci_filter, &events, sizeof events) != 0 ||
        ::bind(x.get(), plain(here), sizeof here) != 0)
      return last_error();
    return x;
  }

private:
  std::uint16_t number_;
  bluetooth_octets address_;
};

/// Of `hci0`
std::optional<std::uint16_t> number_of(std::string_view name) {
  constexpr std::string_view prefix = "hci";
  if (!name.starts_with(prefix))
    return std::nullopt;
  std::uint16_t number = 0;
  const auto* const end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data() + prefix.size(), end, number);
  return error == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

} // namespace

std::variant<std::unique_ptr<bluetooth_adapter>, std::string>
open_bluetooth_adapter(const std::string& name) {
  const descriptor x(::socket(AF_BLUETOOTH, SOCK_RAW | SOCK_CLOEXEC, protocol_hci));
  if (x.get() == -1)
    return why_no_adapter(name, last_error());
  const auto number = number_of(name);
  hci_device_info info{};
  info.device = number.value_or(0);
  if (!number)
    return why_no_adapter(name, std::make_error_code(std::errc::no_such_device));
  if (::ioctl(x.get(), get_device_info, &info) != 0)
    return why_no_adapter(name, last_error());
  if ((info.flags & device_is_up) == 0)
    return why_no_adapter(name, std::make_error_code(std::errc::network_down));
  return std::make_unique<kernel_adapter>(*number, reversed(info.address));
}

#else

std::variant<std::unique_ptr<bluetooth_adapter>, std::string>
open_bluetooth_adapter(const std::string& name) {
  return why_no_adapter(name, std::make_error_code(std::errc::address_family_not_supported));
}

#endif

} // namespace rubicon::io
