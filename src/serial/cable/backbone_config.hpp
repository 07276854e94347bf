// What a file may say about the backbone of a further sink.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/time.hpp"

namespace rubicon::serial {

/// Two serial cables and the PC between them.
struct backbone_config {
  std::uint32_t baud = 57600; ///< of both
  duration latency = 2ms; ///< of both adapters and drivers, in each direction; line_config has one
  duration jitter = 1ms;  ///< up to so much more: a frame of full-speed USB (USB 2.0, 5.3)
  std::size_t queue = 32; ///< packets in transit, in each direction; more are lost and counted
};

} // namespace rubicon::serial
