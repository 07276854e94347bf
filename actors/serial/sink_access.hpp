// Ways to a real sink: a serial port of this computer, or a serial forwarder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "actors/messages/serial.hpp"
#include "io/loop.hpp"

namespace rubicon {

/// One of them, which comes and goes. Its user hears from the loop's thread: serial_presence when
/// it has come, or cannot be had, or has gone; serial_octets of the frames of the sink.
class sink_access {
public:
  virtual ~sink_access() = default;
  sink_access() = default;
  sink_access(const sink_access&) = delete;
  sink_access& operator=(const sink_access&) = delete;

  /// Ends in a serial_presence, which may come at once.
  virtual void open() = 0;

  /// Without a word.
  virtual void close() = 0;

  /// Frames for the sink. @returns whether they go: it is there, and has room for them
  virtual bool send(const payload& octets) = 0;

  /// The user has handled the last serial_octets. Until then no more is read, so that one waits at
  /// most.
  virtual void on_taken() = 0;
};

struct sink_access_config {
  serial::outside_config outside; ///< with a device or a forwarder
  std::uint32_t baud = 57600;
  std::size_t buffer = 4096; ///< octets that may wait to be sent
};

/// @param loop must outlive it
/// @param user owns it
[[nodiscard]] std::unique_ptr<sink_access> make_access(io::loop& loop, const sink_access_config& x,
                                                       outside_line_actor user);

/// In words: `/dev/ttyUSB0, 57600 baud`.
[[nodiscard]] std::string name_of(const sink_access_config& x);

} // namespace rubicon
