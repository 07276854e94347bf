// The gateway's end of a line to motes with plain programs of TinyOS: which packets are theirs, and
// how they are spoken to (tinyos.md 3). The serial port below it is its owner's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "gateway/plain/plain_motes.hpp"
#include "gateway/plain/plain_rule.hpp"
#include "serial/host_port.hpp"

namespace rubicon::gateway {

struct plain_line_config {
  plain_config motes;
  /// The line has real motes alone, with these addresses; nothing: it has a sink of ours, too.
  std::optional<address_range> range;
  std::uint8_t group = 0; ///< of packets to them
};

/// How each packet and each input has ended, while this was there. Where the line has a sink of
/// ours, too, what that one says does not count, nor does what is no packet at all.
struct plain_line_counters {
  std::uint64_t packets = 0; ///< = taken + sum of dropped
  std::uint64_t taken = 0;
  std::map<std::string, std::uint64_t> dropped; ///< out_of_range, no_rule, malformed, no_data,
                                                ///< table_full
  std::uint64_t inputs = 0; ///< = inputs_sent + sum of inputs_failed + those still waiting
  std::uint64_t inputs_sent = 0;
  std::map<std::string, std::uint64_t> inputs_failed; ///< no_ack, queue_full, refused
};
RUBICON_FIELDS(plain_line_counters, packets, taken, dropped, inputs, inputs_sent, inputs_failed);

/// Packets are serial active messages, or raw frames of 802.15.4 from a base station that says
/// those; packets to it then have the same form.
class plain_line {
public:
  plain_line() = default;
  explicit plain_line(plain_line_config config)
      : config_(std::move(config)), motes_(config_.motes) {}

  /// @param packet dispatch octet first
  /// @returns what a sink would have said; nothing: it is of no mote of this line
  [[nodiscard]] std::optional<std::vector<sink_packet>> on_packet(byte_view packet, instant now);

  /// @returns the packet for the serial port, which says by on_sent() and on_lost() what has become
  /// of it, also if it is too long for the base station; nothing: it cannot be said, and has failed
  [[nodiscard]] std::optional<bytes> on_input(mote_id mote, std::uint16_t channel,
                                              byte_view octets);
  void on_sent() { ++counters_.inputs_sent; }
  void on_lost(serial::lost_cause cause);

  void on_presence(bool there, instant now) { motes_.on_line(there, now); }

  /// What a sink would have said: somebody has left.
  [[nodiscard]] std::vector<sink_packet> on_time(instant now) { return motes_.on_time(now); }
  [[nodiscard]] std::optional<instant> deadline() const { return motes_.deadline(); }

  [[nodiscard]] const plain_line_counters& counters() const { return counters_; }

private:
  void drop(const char* cause);

  plain_line_config config_;
  plain_motes motes_;
  bool is_raw_ = false;       ///< the newest packet was
  std::uint8_t sequence_ = 0; ///< of raw frames to them
  plain_line_counters counters_;
};

} // namespace rubicon::gateway
