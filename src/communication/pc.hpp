// The Communication Layer of a PC or robot: the same layer as a mote's, with messages between PEIS
// kernels below it (D1.1 4.1, Table 2; PAR-01..03, PAR-05, ADR-07). A gateway has one too.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "communication/layer.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "synaptic/rubicon_clock.hpp"

namespace rubicon::communication {

/// PEIS port of messages to islands and between PCs (WIR-02).
inline constexpr std::uint16_t island_message_port = 21;

/// Send this message (WIR-02) to a peer, PEIS port 21: a gateway, or another PC.
struct peer_message {
  peer_id peer;
  bytes octets;
};

using outputs = std::vector<transport::to_network>;

/// What carries a packet to another peer, or to a mote of another's island.
[[nodiscard]] peer_message message_of(transport::to_network x);

struct pc_config {
  peer_id self;
  std::uint32_t incarnation = 0;              ///< how often it has been started before
  std::chrono::milliseconds tick_period{500}; ///< of the RUBICON clock (CLK-03)
  transport::answer_slacks slacks = {};
  bool awaits_clock = false;  ///< it does not tick before on_clock()
  duration ack_wait = 500ms;  ///< transport::messenger_config's
  std::size_t sends_max = 64; ///< reliable messages in flight
  std::size_t channels_max =
      64; ///< streams; synaptic channels in each direction; a quarter of the tunnels
  std::uint8_t vector_max = 64; ///< elements of a synaptic channel
};

struct pc_counters {
  std::uint64_t malformed = 0;
  std::uint64_t misdirected = 0; ///< for a mote
  std::uint64_t no_transducer = 0;
};
RUBICON_FIELDS(pc_counters, malformed, misdirected, no_transducer);

/// Its address is its PEIS id as island, no_mote as mote. The RUBICON clock ticks at multiples of
/// its period in the time that peers share, and T is their number (32 bits): so it does in all
/// islands, too (network::clock_sync). Without programs there is no clock.
class pc {
public:
  pc() = default;
  pc(pc_config config, random_stream rng);

  /// A program on this PC. Commands that are not given from within an event are preceded by begin()
  /// and followed by flush(). @param events outlives this
  [[nodiscard]] interface attach(communication_events& events);

  /// As layer::observe().
  void observe(std::function<void(const program_note&)> observer);

  /// Gets the messages of types that no program provides (layer). @param events as above
  [[nodiscard]] interface attach_for_rest(communication_events& events) {
    return layer_->attach_for_rest(events);
  }

  void begin(instant now) { layer_->set_time(now); }
  [[nodiscard]] outputs flush();

  [[nodiscard]] outputs start(instant now); ///< the kernel is up: programs are joined

  /// A message on PEIS port 21.
  [[nodiscard]] outputs on_message(peer_id source, byte_view octets, instant now);

  /// A packet for this PC, without its header. @param source island it comes from
  [[nodiscard]] outputs on_packet(island_id source, std::uint16_t channel, byte_view body,
                                  instant now);

  /// At a gateway: its island has a member more, or one that has been started again (MCK-15).
  [[nodiscard]] outputs on_mote_joined(mote_id mote, byte_view description, instant now);
  /// At a gateway: whether its sink is connected. While it is not, initCommunications() fails
  /// (MCK-13).
  void set_line(bool up) { line_up_ = up; }
  void forget_incarnation(mote_address x) { layer_->forget_incarnation(x); }

  /// The time that peers share is so much ahead of `now`, since 1970 (CLK-06).
  [[nodiscard]] outputs on_clock(duration ahead, instant now);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] const layer& above() const { return *layer_; }
  [[nodiscard]] const pc_counters& counters() const { return counters_; }

private:
  void perform(layer_output& x, outputs& out);
  void tick(instant now);

  pc_config config_;
  std::unique_ptr<layer> layer_; ///< programs point to it
  synaptic::rubicon_clock clock_;
  std::optional<duration> ahead_; ///< of the time that peers share
  bool has_programs_ = false;
  bool line_up_ = true; ///< or there is none
  instant now_;
  pc_counters counters_;
};

} // namespace rubicon::communication
