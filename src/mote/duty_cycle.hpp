// When a mote's radio is on, and when its frames may go so that the others' are too (D1.1 3.3.3.1;
// NRG-01..04).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/small_map.hpp"
#include "core/time.hpp"
#include "mote/duty_config.hpp"
#include "network/channels/channels.hpp"
#include "network/channels/radio_schedule.hpp"
#include "network/clock/time_estimate.hpp"
#include "network/router.hpp"

namespace rubicon::mote {

struct radio_switch {
  bool on = true;
};

using duty_output = std::variant<network::frame_out, radio_switch>;
using duty_outputs = std::vector<duty_output>;

/// The radio is on in the common window and around each packet that a channel through this mote
/// expects, longer by twice the uncertainty of the clock: the sender's may be as wrong as ours.
/// While the island's time is not known well enough it is always on, as a sink's is, unless a
/// search has found no mote that knows (network::time_search).
///
/// Frames without a schedule come when their turn is (network/turns.hpp). A packet of a channel
/// goes on when the next mote expects it, or at once if it is late.
class duty_cycle {
public:
  duty_cycle() = default;
  duty_cycle(duty_config config, bool is_sink) : config_(config), is_sink_(is_sink) {}

  /// A channel needs the radio at these times; no longer, if the interval is 0.
  void reserve(const network::channel_reserved& x);

  /// A frame for the radio: it comes out at once, or in a later update().
  void submit(network::frame_out x) { held_.push_back({std::move(x)}); }

  /// A frame that came out has ended.
  void on_sent(std::uint64_t token);

  /// A frame arrived. One that carries a packet of a channel may come again: its sender repeats it
  /// when our acknowledgement was lost.
  void on_frame(std::uint8_t am_type, byte_view payload, instant now);

  /// A packet of this channel has come to its end here.
  void on_received(network::channel_id channel) { served_.push_back(channel); }

  /// A mote sleeps only while it is a member, or rests from a search.
  void set_member(bool x) { is_member_ = x; }

  /// To be called after each of these, at deadline(), and when the clock was corrected.
  [[nodiscard]] duty_outputs update(instant now, const network::time_estimate& clock,
                                    const network::time_search& search);
  [[nodiscard]] std::optional<instant> deadline() const { return due_; }

  /// When the next packet of a channel may go at its source; nothing: at any time.
  [[nodiscard]] std::optional<instant> next_turn(network::channel_id channel, instant now,
                                                 const network::time_estimate& clock) const;

  [[nodiscard]] bool is_on() const { return on_; }
  [[nodiscard]] static std::size_t footprint(std::size_t channels) { return 24 + channels * 16; }

private:
  struct passing { ///< a channel
    network::channel_reserved reserved;
    instant repeats_until = {}; ///< of the packet that arrived last
  };
  struct held {
    network::frame_out frame;
    std::optional<instant> due = {};                 ///< nothing: not looked at yet
    std::optional<network::channel_id> channel = {}; ///< whose packet it carries
  };

  [[nodiscard]] bool applies(instant now, const network::time_estimate& clock) const {
    return config_.common().applies(now, clock);
  }
  [[nodiscard]] std::chrono::microseconds guard(instant now,
                                                const network::time_estimate& clock) const;
  [[nodiscard]] instant next_departure(const network::channel_reserved& x, instant now,
                                       const network::time_estimate& clock) const;
  [[nodiscard]] instant departure(const held& x, instant now,
                                  const network::time_estimate& clock) const;
  void switch_radio(bool sends, duty_outputs& out, instant now, const network::time_estimate& clock,
                    const network::time_search& search);
  [[nodiscard]] bool is_due(instant now, const network::time_estimate& clock);
  [[nodiscard]] instant repeats_until(network::channel_id channel) const;

  duty_config config_;
  bool is_sink_ = false;
  network::radio_schedule schedule_;
  small_map<network::channel_id, passing> channels_;
  std::vector<held> held_;
  small_map<std::uint64_t, std::optional<network::channel_id>> in_flight_; ///< by token
  std::vector<network::channel_id> served_; ///< taken or sent on; the schedule has to learn of it
  bool is_member_ = false;
  std::optional<instant> due_;
  bool on_ = true;
};

} // namespace rubicon::mote
