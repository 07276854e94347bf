// One TCP connection as a stream of octets (peis-wire.md 3.4).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "io/loop.hpp"

namespace rubicon::io {

/// Both directions of an established connection. Small writes leave at once (TCP_NODELAY), what is
/// received is acknowledged at once where the system can be asked to (TCP_QUICKACK): real PEIS
/// kernels wait for it. Callbacks run on the loop's thread, never from within a call, and may
/// destroy the stream.
class tcp_stream {
public:
  struct callbacks {
    /// What has arrived; valid during the call.
    std::function<void(byte_view)> on_octets;
    /// So many octets of what send() was given have been handed to the system.
    std::function<void(std::size_t)> on_sent;
    /// The other side has closed it or the network has failed; once, nothing follows.
    std::function<void(const std::string& why)> on_closed;
  };

  /// How long close() waits for output to leave, then for the other side to close too.
  static constexpr duration drain_max = 2s;
  static constexpr duration linger_max = 250ms;
  /// Octets that the system may hold without having put them on the network. More would only make
  /// what is urgent wait behind them (P2P-02).
  static constexpr int unsent_in_system = 256 * 1024;

  /// No connection; may only be assigned to.
  tcp_stream();
  /// Drops the connection unless close() has been called.
  ~tcp_stream();
  tcp_stream(tcp_stream&&) noexcept;
  tcp_stream& operator=(tcp_stream&&) noexcept;

  /// Begins to receive. Before it nothing is read. @pre called once at most
  void start(callbacks x);

  /// Whether more is to be received. While not, what comes waits in the system and then at the
  /// other side, whose closing is noticed later. @pre start() was called
  void read(bool wanted);

  /// Queues octets; what was queued in one turn of the loop leaves in one write. The queue has no
  /// bound of its own: the owner counts with on_sent. @pre start() was called
  void send(payload octets);

  /// From now on what each send() was given leaves as a whole, as soon as the other side has room
  /// for all of it, and on_sent reports what the other side's system has acknowledged. For readers
  /// that wait for a whole with their window closed. @pre start() was called
  void pace();

  /// Octets that send() was given and that have not been handed to the system.
  [[nodiscard]] std::size_t unsent() const;

  /// Ends the connection after what is queued has left, at the latest after drain_max + linger_max.
  /// No callback but `done` comes from now on; the stream may be destroyed meanwhile.
  void close(std::function<void()> done = {});

  /// Ends the connection at once: the other side learns that it is broken, and not only after what
  /// it may be waiting for. The stream may be destroyed then; no callback comes any more.
  void reset();

  /// `127.0.0.1:8000`
  [[nodiscard]] std::string remote_address() const;

  /// For the other files of this room.
  struct state;
  explicit tcp_stream(std::shared_ptr<state> x);

private:
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
