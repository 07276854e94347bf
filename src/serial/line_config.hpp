// What a file may say about the cable between a sink and its basestation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <ratio>

#include "core/time.hpp"

namespace rubicon::serial {

/// A serial cable with 10 bit times an octet (tinyos.md 1.1).
struct line_config {
  std::uint32_t baud = 57600;
  duration latency = 1ms;    ///< USB adapter and driver, each way
  double octet_error = 0;    ///< chance that one octet is corrupted, 0..1
  std::size_t buffer = 4096; ///< octets waiting to be sent, each way; more are lost and counted
};

/// How long `octets` occupy one direction of a line. @pre baud > 0
[[nodiscard]] constexpr duration transmission_time(std::size_t octets, std::uint32_t baud) {
  return duration(static_cast<std::int64_t>(octets) * 10 * std::nano::den / baud);
}

} // namespace rubicon::serial
