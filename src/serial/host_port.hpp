// The PC side of a TinyOS serial line (tinyos.md 1.1 to 1.3; A-50, GW-16).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bounded_queue.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "serial/ack_patience.hpp"
#include "serial/cable/line_end.hpp"
#include "serial/frame.hpp"
#include "serial/packet.hpp"

namespace rubicon::serial {

struct packet_tag;

/// Names one send to its owner, who chooses it.
using packet_id = strong_id<packet_tag, std::uint64_t>;

enum class lost_cause : std::uint8_t {
  queue_full,
  no_ack,    ///< attempts used up; the mote may have it all the same
  too_long,  ///< more than the mote takes: it would not recover (tinyos.md 3)
  malformed, ///< no dispatch octet, or an AM length that is not that of the octets
};

[[nodiscard]] std::string_view to_string(lost_cause x);

/// Why a packet must not be written to a mote that takes AM payloads of so many octets, as serial
/// active messages or in raw frames. @param packet dispatch octet first
[[nodiscard]] std::optional<lost_cause> objection_to(byte_view packet, std::size_t payload_max);

/// The mote has acked it.
struct sent {
  packet_id id;
};

struct lost {
  packet_id id;
  lost_cause cause = lost_cause::no_ack;
};

using output = std::variant<to_line, received, sent, lost>;
using outputs = std::vector<output>;

struct host_port_config {
  /// Longest wait after one attempt, see ack_patience; longer where the line itself needs longer:
  /// for the attempt, for a frame that the mote has begun to write, and for the ack.
  duration ack_wait = 100ms;
  std::uint32_t baud = 57600; ///< of the line, > 0
  duration latency = 1ms;     ///< of the line, in each direction
  /// Packets in flight: 1, as TinyOS's own programs do, or 2, for which a mote has buffers. Two
  /// keep a slow line in use while an ack waits for what the mote is writing; the second may
  /// overtake a first one that has to be repeated.
  std::size_t window = 1;
  unsigned attempts_max = 4;                ///< 1..64
  std::size_t queue_max = 64;               ///< packets waiting behind the one that is outstanding
  std::size_t payload_max = am_payload_max; ///< AM payload that the mote is compiled for
};

struct host_port_counters {
  std::uint64_t accepted = 0; ///< = sent + no_ack + those queued or outstanding
  std::uint64_t sent = 0;
  std::uint64_t no_ack = 0;
  std::uint64_t queue_full = 0;
  std::uint64_t refused = 0;  ///< too long or malformed
  std::uint64_t attempts = 0; ///< packet frames written, repeats included
  std::uint64_t acks_written = 0;
  std::uint64_t urgent = 0;          ///< packets written at once, without asking for an ack
  std::uint64_t received = 0;        ///< packets passed up
  std::uint64_t empty = 0;           ///< received without a dispatch octet, not passed up
  std::uint64_t stray_acks = 0;      ///< for no attempt of the outstanding packet
  std::uint64_t unknown_answers = 0; ///< the mote did not know a frame's type
};
RUBICON_FIELDS(host_port_counters, accepted, sent, no_ack, queue_full, refused, attempts,
               acks_written, urgent, received, empty, stray_acks, unknown_answers);

/// Framing, acks in both directions, a packet or two at a time. Every send ends in exactly one sent
/// or lost. Each attempt has a sequence number of its own, so that an ack identifies the attempt
/// that it answers; motes do not suppress duplicates and neither does this side (tinyos.md 1.3).
///
///   idle --send--> waiting --ack of any attempt--> sent, next packet
///                   |   ^
///          deadline +---+ written again; attempts used up: lost, next packet
class host_port {
public:
  enum class state : std::uint8_t { idle, waiting };

  host_port() : host_port(host_port_config{}) {}
  explicit host_port(host_port_config config);

  /// @param packet dispatch octet first
  [[nodiscard]] outputs send(packet_id id, bytes packet, instant now);

  /// Writes a packet at once, behind the frames that are being written, without asking for an ack:
  /// for answers that are of no use when they are late. @pre objection_to() has none
  [[nodiscard]] outputs send_urgent(byte_view packet, instant now);

  /// How long such a packet waits for the line.
  [[nodiscard]] duration wait(instant now) const { return std::max(line_free_, now) - now; }

  [[nodiscard]] outputs on_bytes(byte_view octets, instant now);
  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()

  /// The mote takes longer payloads than was known.
  void set_payload_max(std::size_t x) { config_.payload_max = x; }
  [[nodiscard]] std::size_t payload_max() const { return config_.payload_max; }

  /// When on_time() is due; nothing while idle.
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] state current() const { return in_flight_.empty() ? state::idle : state::waiting; }
  [[nodiscard]] std::size_t queued() const { return queue_.size(); }
  [[nodiscard]] const host_port_counters& counters() const { return counters_; }
  [[nodiscard]] const frame_counters& frames() const { return decoder_.counters(); }

private:
  struct outgoing {
    packet_id id;
    bytes packet;
    provenance from = {};
  };

  struct attempt {
    std::uint8_t sequence = 0;
    instant left; ///< its last octet has
  };

  struct waiting {
    outgoing what;
    std::vector<attempt> attempts{}; ///< at most attempts_max
    instant due{};                   ///< of the next one, or of giving up
  };

  void on_frame(frame x, instant now, outputs& out);
  void on_ack(std::uint8_t sequence, instant now, outputs& out);
  void pass_up(bytes packet, outputs& out);
  void write_attempt(waiting& x, instant now, outputs& out);
  void fill_window(instant now, outputs& out);
  [[nodiscard]] duration on_line(std::size_t octets) const;

  host_port_config config_;
  frame_decoder decoder_;
  ack_patience patience_;
  bounded_queue<outgoing> queue_;
  std::vector<waiting> in_flight_;     ///< at most window
  instant line_free_ = instant::min(); ///< what we have written has left
  std::uint8_t next_sequence_ = 0;
  host_port_counters counters_;
};

} // namespace rubicon::serial
