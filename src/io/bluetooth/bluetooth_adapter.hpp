// A Bluetooth adapter of this computer, through the sockets of the kernel: no library is needed.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <system_error>
#include <variant>
#include <vector>

#include "io/descriptor.hpp"

namespace rubicon::io {

/// Octets of a device's address, in the order in which people write them.
using bluetooth_octets = std::array<std::uint8_t, 6>;

/// Where the sockets of one adapter come from. None of them blocks; each packet that is written or
/// read is one packet of the medium.
class bluetooth_adapter {
public:
  using opened = std::variant<descriptor, std::error_code>;

  virtual ~bluetooth_adapter() = default;

  [[nodiscard]] virtual bluetooth_octets address() const = 0;

  /// A socket that accepts connections at that L2CAP port; address_in_use if another one does.
  [[nodiscard]] virtual opened listen(std::uint16_t port) = 0;

  /// A socket that is about to connect: it becomes writable when it has, or has failed.
  [[nodiscard]] virtual opened connect(const bluetooth_octets& to, std::uint16_t port) = 0;

  /// A socket for HCI packets to and from the adapter.
  [[nodiscard]] virtual opened open_controller() = 0;
};

/// @param name `hci0`
/// @returns the adapter, or why it cannot be used: `cannot open Bluetooth adapter hci0: ...`
[[nodiscard]] std::variant<std::unique_ptr<bluetooth_adapter>, std::string>
open_bluetooth_adapter(const std::string& name);

/// `hci0` and so on, sorted: those that this computer has, whether they can be used or not.
[[nodiscard]] std::vector<std::string> bluetooth_adapters();

/// The sentence about an adapter that the system refuses with this error.
[[nodiscard]] std::string why_no_adapter(const std::string& name, const std::error_code& error);

} // namespace rubicon::io
