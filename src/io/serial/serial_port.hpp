// A real serial port, with a mote at its other end (tinyos.md 1.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "core/bytes.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

class descriptor_channel;

/// Octets as they are, eight bits without parity and one stop bit, no flow control. Callbacks run
/// on the loop's thread, never from within a call, and may destroy the port.
class serial_port {
public:
  struct callbacks {
    /// What has arrived; valid during the call.
    std::function<void(byte_view)> on_octets;
    /// The adapter was pulled out, or the other side of a pseudo-terminal has gone; once, nothing
    /// follows.
    std::function<void(const std::string& why)> on_closed;
  };

  /// @param room octets that may wait to be written
  /// @returns the port, or why it cannot be had and what to do about it
  [[nodiscard]] static std::variant<serial_port, std::string>
  open(loop& where, const std::string& path, std::uint32_t baud, std::size_t room);

  /// No port; may only be assigned to.
  serial_port();
  ~serial_port();
  serial_port(serial_port&&) noexcept;
  serial_port& operator=(serial_port&&) noexcept;

  /// Begins to receive. @pre called once
  void start(callbacks x);

  /// Whether more is to be received. While not, what comes waits in the system.
  void read(bool wanted);

  /// @returns whether there was room for all of the octets; otherwise none of them goes
  bool send(payload octets);

private:
  explicit serial_port(std::shared_ptr<descriptor_channel> x);

  std::shared_ptr<descriptor_channel> channel_;
};

} // namespace rubicon::io
