// A gateway's end of the packets to and from its sink.
#pragma once

#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "gateway/occasion.hpp"
#include "network/island_packet.hpp"
#include "transport/fragments.hpp"

namespace rubicon::gateway {

/// Whether anything is received from the sink (GW-15), and packets to and from it: each whole, or
/// in fragments.
///
///   silent --packet--> up --silence_max without a packet--> silent
class sink_port {
public:
  sink_port() = default;
  explicit sink_port(duration silence_max);

  /// A packet was received. @returns whether the line was silent before
  bool on_packet(const occasion& at);
  /// Harmless before deadline(). @returns whether the line has become silent
  bool on_time(const occasion& at);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// @returns the packet if this fragment is the last one missing
  [[nodiscard]] std::optional<bytes> on_fragment(mote_id source, byte_view payload, instant now) {
    return fragments_.on_fragment(source, payload, now);
  }

  /// @param x its island is where it comes from
  void send(const network::island_packet& x, const occasion& at);

  /// The sink has sent something that only the islands' own program sends.
  void note_own_sink() { has_own_sink_ = true; }

  [[nodiscard]] bool is_up() const { return up_; }
  [[nodiscard]] bool has_own_sink() const { return has_own_sink_; }
  [[nodiscard]] const transport::assembly& fragments() const { return fragments_; }

private:
  duration silence_max_{};
  std::optional<instant> last_packet_; ///< nothing: none was ever received
  bool up_ = false;
  bool has_own_sink_ = false;
  transport::assembly fragments_; ///< of packets from the sink
  std::uint8_t tag_ = 0;          ///< of the next packet in fragments
};

} // namespace rubicon::gateway
