// One connection of a socket that keeps packets apart, such as L2CAP of Bluetooth.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "io/descriptor.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

/// Both directions of an established connection. Callbacks run on the loop's thread, never from
/// within a call, and may destroy the stream.
class packet_stream {
public:
  struct callbacks {
    /// One packet that has arrived; valid during the call.
    std::function<void(byte_view)> on_packet;
    /// So many octets of what send() was given have been handed to the system.
    std::function<void(std::size_t)> on_sent;
    /// The other side has closed it, the medium has failed, or a packet was too long; once,
    /// nothing follows.
    std::function<void(const std::string& why)> on_closed;
  };

  static constexpr std::size_t packet_max = 2048; ///< a longer one ends the connection
  static constexpr std::size_t packet_min = 48;   ///< each medium takes packets of this size
  static constexpr duration drain_max = 2s;       ///< how long close() waits for output to leave

  /// No connection; may only be assigned to.
  packet_stream();
  /// @param room octets that may wait to be written
  packet_stream(loop& where, descriptor connected, std::size_t room);
  /// Drops the connection unless close() has been called.
  ~packet_stream();
  packet_stream(packet_stream&&) noexcept;
  packet_stream& operator=(packet_stream&&) noexcept;

  /// Begins to receive. @pre called once
  void start(callbacks x);

  /// Whether more is to be received. While not, what comes waits in the system. @pre start() was
  /// called
  void read(bool wanted);

  /// Queues octets that leave as one packet, or as several if the medium takes smaller ones only.
  /// @pre start() was called
  /// @returns whether there was room for all of them; otherwise none of them goes
  bool send(payload packet);

  /// Octets that wait to be written.
  [[nodiscard]] std::size_t unsent() const;

  /// Ends the connection after what is queued has left, at the latest after drain_max. No callback
  /// but `done` comes from now on; the stream may be destroyed meanwhile.
  void close(std::function<void()> done = {});

private:
  struct state;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
