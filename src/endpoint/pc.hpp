// The Communication Layer of a PC or robot: the same layer as a mote's, with messages between PEIS
// kernels below it (D1.1 4.1, Table 2; PAR-01..03, PAR-05, ADR-07).
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/random.hpp"
#include "core/time.hpp"
#include "mote/layer.hpp"
#include "synaptic/rubicon_clock.hpp"

namespace rubicon::endpoint {

/// Send this message (WIR-02) to a peer, PEIS port 21: a gateway, or another PC.
struct peer_message {
  peer_id peer;
  bytes octets;
};

using outputs = std::vector<peer_message>;

struct pc_config {
  peer_id self;
  std::uint32_t incarnation = 0;              ///< how often it has been started before
  std::chrono::milliseconds tick_period{500}; ///< of the RUBICON clock (CLK-03)
  std::size_t channels_max = 64;              ///< streams; synaptic channels each way; tunnels
  std::uint8_t vector_max = 64;               ///< elements of a synaptic channel
};

struct pc_counters {
  std::uint64_t malformed = 0;
  std::uint64_t misdirected = 0; ///< for a mote
  std::uint64_t no_transducer = 0;
};

/// Its address is its PEIS id as island, no_mote as mote. The RUBICON clock shows the time of the
/// run: T is 0 when it begins.
class pc {
public:
  pc() = default;
  pc(pc_config config, random_stream dice);

  /// A program on this PC. Commands that are not given from within an event are preceded by begin()
  /// and followed by settle(). @param events outlives this
  [[nodiscard]] mote::communication attach(mote::communication_events& events);
  void begin(instant now) { layer_->set_time(now); }
  [[nodiscard]] outputs settle();

  [[nodiscard]] outputs start(instant now); ///< the kernel is up: programs are joined

  /// A message on PEIS port 21.
  [[nodiscard]] outputs on_message(peer_id source, byte_view octets, instant now);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] const mote::layer& above() const { return *layer_; }
  [[nodiscard]] const pc_counters& counters() const { return counters_; }

private:
  void perform(mote::layer_output& x, outputs& out);
  void tick(instant now);

  pc_config config_;
  std::unique_ptr<mote::layer> layer_; ///< programs point to it
  synaptic::rubicon_clock clock_;
  instant now_;
  pc_counters counters_;
};

} // namespace rubicon::endpoint
