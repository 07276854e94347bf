// What is asked of a sink without an ecology: `rubicon serial`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "cli/words/exit_status.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "serial/cable/line_config.hpp"

namespace rubicon::cli {

/// `rubicon serial listen SOURCE`
struct listen_serial {
  std::optional<duration> length;     ///< unset: until interrupted
  std::optional<std::uint64_t> count; ///< of packets
  bool json = false;
};

/// `rubicon serial send SOURCE TYPE [PAYLOAD]`
struct send_serial {
  std::uint16_t destination = 0xffff;
  std::uint8_t group = 0x22;
  std::uint8_t am_type = 0;
  bytes payload;
};

/// `rubicon serial forward SOURCE ADDRESS:PORT`
struct forward_serial {
  std::string address = "127.0.0.1";
  std::uint16_t port = 9002;
  std::optional<duration> length; ///< unset: until interrupted
};

struct serial_command {
  std::string device; ///< a serial port; empty: a forwarder
  std::string host;   ///< of the forwarder
  std::uint16_t port = 9002;
  std::uint32_t baud = 57600;
  std::size_t payload_max = serial::base_station_payload; ///< of the mote at the port
  std::variant<listen_serial, send_serial, forward_serial> what;
};

[[nodiscard]] exit_status perform(const serial_command& x);

} // namespace rubicon::cli
