// The sink's half of the bridge between an island and its gateway (GW-01, RTG-02): radio on one
// side, serial packets on the other, the list of members in between.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "mote/registrar.hpp"
#include "network/star.hpp"

namespace rubicon::mote {

/// Send this packet up the serial line.
struct to_gateway {
  mote_id source; ///< whose radio frame it was; the sink itself for its own events
  std::uint8_t am_type = 0;
  bytes payload;
};

using sink_output = std::variant<network::transmit, to_gateway>;
using sink_outputs = std::vector<sink_output>;

struct sink_counters {
  std::uint64_t malformed = 0;    ///< serial packets that could not be decoded
  std::uint64_t unknown_type = 0; ///< frames or packets of a type that has no business here
  std::uint64_t up = 0;           ///< island packets passed to the gateway
  std::uint64_t down = 0;         ///< island packets passed to the island
};

class sink {
public:
  sink() = default;
  sink(mote_id self, registrar_config config) : self_(self), registrar_(config) {}

  [[nodiscard]] sink_outputs start(instant now);

  /// The radio has delivered a frame.
  [[nodiscard]] sink_outputs on_frame(mote_id source, std::uint8_t am_type, byte_view payload,
                                      instant now);

  /// The serial line has delivered a packet from the gateway.
  [[nodiscard]] sink_outputs on_packet(std::uint8_t am_type, byte_view payload, instant now);

  [[nodiscard]] sink_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const { return registrar_.deadline(); }

  [[nodiscard]] std::size_t members() const { return registrar_.members(); }
  [[nodiscard]] const sink_counters& counters() const { return counters_; }

private:
  [[nodiscard]] sink_outputs take(registrar_outputs from_registrar) const;

  mote_id self_;
  registrar registrar_;
  sink_counters counters_;
};

} // namespace rubicon::mote
