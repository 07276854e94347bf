// What the machine says of itself: its name and its network interfaces (LNK-03).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rubicon::io {

/// An IPv4 address of an interface that is up.
struct network_interface {
  std::string device;                 ///< `eth0`
  std::array<std::uint8_t, 4> ipv4{}; ///< a.b.c.d, first one first
  bool loopback = false;

  friend bool operator==(const network_interface&, const network_interface&) = default;
};

/// In the system's order; one entry an address. Empty if the system does not report them.
[[nodiscard]] std::vector<network_interface> network_interfaces();

/// Whether this computer has an IPv4 address now: `192.168.1.5`; 0.0.0.0 and 127.0.0.0/8 always.
[[nodiscard]] bool has_address(const std::string& address);

/// The first label of the machine's name: `kitchen` of `kitchen.example.org`; `localhost` if it has
/// none.
[[nodiscard]] std::string machine_name();

/// The system's clock, which may be wrong: microseconds since 1970, UTC.
[[nodiscard]] std::int64_t system_clock_us();

/// Microseconds since this computer started, those included for which it was suspended: it never
/// steps.
[[nodiscard]] std::int64_t time_since_boot_us();

/// How many files and connections this process may have open.
[[nodiscard]] std::size_t descriptors_max();

} // namespace rubicon::io
