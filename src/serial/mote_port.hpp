// The mote's side of a TinyOS serial line, quirks included (tinyos.md 1.3, 1.4; GW-16).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/bounded_queue.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "serial/cable/line_end.hpp"
#include "serial/packet.hpp"

namespace rubicon::serial {

using mote_port_output = std::variant<to_line, received>;
using mote_port_outputs = std::vector<mote_port_output>;

struct mote_port_config {
  std::uint32_t baud = 57600;               ///< of the UART, tinyos.md 1.1
  std::size_t payload_max = am_payload_max; ///< AM payload that the mote is compiled for, 0..255
  std::size_t receive_buffers = 2;
  duration service_time = 1ms; ///< how long a received packet keeps its buffer
  std::size_t acks_max = 5;    ///< acks waiting for the UART
  std::size_t queue_max = 12;  ///< packets waiting for the UART (tinyos.md 3)
  std::size_t urgent_max = 4;  ///< of those that go before others
};

/// Packets of the line itself must not wait behind the readings that fill it.
enum class urgency : std::uint8_t { none, before_others };

struct mote_port_counters {
  std::uint64_t frames_received = 0; ///< good CRC
  std::uint64_t received = 0;        ///< packets passed up
  std::uint64_t bad_crc = 0;
  std::uint64_t too_short = 0;        ///< cut off before a CRC could be there
  std::uint64_t too_long = 0;         ///< more than mote_body_max octets after type and sequence
  std::uint64_t unknown_type = 0;     ///< acks of the PC included: a mote expects none
  std::uint64_t no_buffer = 0;        ///< all receive buffers in use when the frame began
  std::uint64_t unknown_dispatch = 0; ///< acked if asked for, not passed up
  std::uint64_t oversized = 0;        ///< acked if asked for, AM length above payload_max
  std::uint64_t acks_sent = 0;
  std::uint64_t acks_lost = 0; ///< queue of acks full
  std::uint64_t packets_sent = 0;
  std::uint64_t queue_full = 0; ///< packets dropped at a full queue, newest first
  std::uint64_t discarded = 0;  ///< packets and acks given up by stop(), packets sent after it
};
RUBICON_FIELDS(mote_port_counters, frames_received, received, bad_crc, too_short, too_long,
               unknown_type, no_buffer, unknown_dispatch, oversized, acks_sent, acks_lost,
               packets_sent, queue_full, discarded);

/// The serial stack of a sink. A frame occupies the UART for its time at the baud rate; acks go
/// before urgent packets, these before others. Packets go out without asking for an ack.
///
///   no_sync --flag--> type --44--> sequence --octet--> body --flag, bad--> type
///      ^ ^              |  `--45-----------------------^ |
///      | `- other type, no buffer                        |
///      `--------------- flag, good; too long ------------'
///
/// So the flag that closes a good frame opens none, while the one that closes a bad frame does. A
/// flag does not clear a pending escape unless it ends a frame.
///
/// Deviation: a packet whose AM length is above payload_max is counted and dropped; it would block
/// TinyOS's BaseStation for good (tinyos.md 3).
class mote_port {
public:
  mote_port() : mote_port(mote_port_config{}) {}

  /// @pre config.baud > 0, config.receive_buffers > 0
  explicit mote_port(mote_port_config config);

  /// @pre packet has 1..packet_octets_max octets, dispatch first
  [[nodiscard]] mote_port_outputs send(bytes packet, instant now, urgency how = urgency::none);

  /// Octets that came in one after the other at the baud rate, the last one now.
  [[nodiscard]] mote_port_outputs on_bytes(byte_view octets, instant now);
  [[nodiscard]] mote_port_outputs on_time(instant now); ///< harmless before deadline()

  /// When the UART is free for what waits; nothing if nothing waits.
  [[nodiscard]] std::optional<instant> deadline() const;

  void stop();  ///< the mote is off: forgets what waits, receives nothing
  void start(); ///< after stop(); a new port is started

  /// How long an urgent packet sent now waits for the frame that the UART is writing.
  [[nodiscard]] duration wait(instant now) const { return std::max(uart_free_at_, now) - now; }

  [[nodiscard]] std::size_t queued() const { return urgent_.size() + packets_.size(); }
  [[nodiscard]] const mote_port_counters& counters() const { return counters_; }

private:
  enum class state : std::uint8_t { no_sync, type, sequence, body, inactive };

  struct buffer {
    bytes octets; ///< AM header and payload; keeps what earlier frames left in it
    instant busy_until = instant::min();
  };

  void on_octet(std::uint8_t octet, instant at, mote_port_outputs& out);
  void on_flag(instant at, mote_port_outputs& out);
  void on_type(std::uint8_t octet, instant at);
  void on_body(std::uint8_t octet);
  void end_body(instant at, mote_port_outputs& out);
  void end_frame(state next);
  void take_packet(instant at, mote_port_outputs& out);
  void pass_up(mote_port_outputs& out);
  void transmit(instant now, mote_port_outputs& out);

  mote_port_config config_;
  instant clock_ = instant::min(); ///< latest time seen

  state state_ = state::no_sync;
  bool escaped_ = false;
  std::uint8_t type_ = 0;
  std::uint8_t sequence_ = 0;
  bytes body_; ///< of the frame coming in, CRC included
  std::vector<buffer> buffers_;
  std::size_t filling_ = 0; ///< the buffer of the frame coming in

  bounded_queue<std::uint8_t> acks_; ///< sequence numbers
  struct waiting {
    bytes packet;
    provenance from = {};
  };
  bounded_queue<waiting> urgent_;
  bounded_queue<waiting> packets_;
  instant uart_free_at_ = instant::min();
  mote_port_counters counters_;
};

} // namespace rubicon::serial
