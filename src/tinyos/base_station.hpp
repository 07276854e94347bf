// TinyOS's BaseStation: frames of the radio go to the serial line, and packets of the line to the
// radio (docs/tinyos.md 3). It knows neither members nor islands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bounded_queue.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "serial/cable/line_config.hpp"
#include "serial/packet.hpp"

namespace rubicon::tinyos {

struct base_station_config {
  std::size_t queue = 12; ///< packets that wait for the radio, the one there included
  std::size_t payload_max = serial::base_station_payload; ///< that it is compiled for
};

/// A frame for the radio: source and PAN are its own, no acknowledgement is asked for.
struct to_radio {
  mote_id destination;
  std::uint8_t am_type = 0;
  bytes payload;
  provenance from = {};
};

/// A frame that the radio has received, whatever its destination.
struct air_frame {
  std::uint16_t pan = 0;
  mote_id destination;
  mote_id source;
  std::uint8_t am_type = 0;
  byte_view payload;
};

struct base_station_counters {
  std::uint64_t up = 0;          ///< frames handed to the line
  std::uint64_t up_too_long = 0; ///< frames with more payload than it is compiled for
  std::uint64_t up_raw = 0;      ///< of `up`, those of other layouts than TinyOS's
  std::uint64_t down = 0;        ///< packets of the line taken for the radio
  std::uint64_t down_malformed = 0;
  std::uint64_t down_full = 0; ///< dropped: its queue is full. The line has acked them all the same
  std::uint64_t down_sent = 0; ///< have left the radio
  std::uint64_t down_repeats = 0; ///< tries after one for which the channel was never clear
  std::uint64_t down_lost = 0;    ///< dropped when the radio was off
};
RUBICON_FIELDS(base_station_counters, up, up_too_long, up_raw, down, down_malformed, down_full,
               down_sent, down_repeats, down_lost);

/// How what was handed to the radio has ended.
enum class radio_result : std::uint8_t {
  sent,
  busy, ///< the channel was: it is tried again, without limit
  off,
};

/// Sans-I/O. Queues are first in, first out, and drop the newest; that towards the line is the
/// serial port's.
class base_station {
public:
  base_station() : base_station(base_station_config{}) {}
  explicit base_station(base_station_config config) : config_(config), queue_(config.queue) {}

  /// @returns the packet for the line: destination, source and AM type as on the radio, the group
  /// is the low octet of the PAN
  [[nodiscard]] std::optional<serial::am_packet> on_frame(const air_frame& x);

  /// A frame whose layout is not TinyOS's. @param frame without its FCS
  /// @returns the packet for the line: that of dispatch 2 (docs/tinyos.md 1.2)
  [[nodiscard]] bytes on_raw_frame(byte_view frame);

  /// The line has delivered a packet. @param packet dispatch octet first
  /// @returns what the radio is to send now
  [[nodiscard]] std::optional<to_radio> on_packet(byte_view packet);

  /// What was returned last has ended. @returns what is next
  [[nodiscard]] std::optional<to_radio> on_radio_done(radio_result x);

  [[nodiscard]] std::size_t queued() const { return queue_.size(); }
  [[nodiscard]] const base_station_counters& counters() const { return counters_; }

private:
  base_station_config config_;
  bounded_queue<to_radio> queue_; ///< the first is at the radio
  base_station_counters counters_;
};

} // namespace rubicon::tinyos
