// The cable between a sink and its basestation, as octets see it (GW-01, GEN-03).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "serial/cable/line_config.hpp"

namespace rubicon::serial {

enum class direction : std::uint8_t { to_pc, to_mote };

[[nodiscard]] std::string to_string(direction x);

/// Give these octets to the reader at that end.
struct arrived {
  direction towards = direction::to_pc;
  payload octets;
  provenance from = {};
};

using line_outputs = std::vector<arrived>;

/// Octets of one direction: written = arrived + overflow + unplugged + those in flight.
struct line_counters {
  std::uint64_t written = 0;
  std::uint64_t arrived = 0;   ///< corrupted ones included
  std::uint64_t corrupted = 0; ///< changed in transit, whether or not they arrived
  std::uint64_t overflow = 0;  ///< lost at a full buffer
  std::uint64_t unplugged = 0; ///< lost because no cable was there
};
RUBICON_FIELDS(line_counters, written, arrived, corrupted, overflow, unplugged);

/// Two independent directions. Each sends its octets one after the other at the line's baud rate,
/// with 10 bit times an octet, and changes each with the configured chance. What a writer wrote at
/// once arrives at once, when its last octet does. The latency of the PC's adapter is not the
/// line's: whoever is at that end waits for it, in each direction.
class line {
public:
  line() = default;

  /// @pre config.baud > 0
  line(line_config config, random_stream rng);

  /// Octets beyond what the buffer still takes are lost from the end of the chunk.
  void send(direction towards, payload octets, instant now);

  [[nodiscard]] line_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Loses what is in flight, and what is written until plug().
  /// @returns what had arrived by `now`
  [[nodiscard]] line_outputs unplug(instant now);
  void plug() { plugged_ = true; }

  [[nodiscard]] bool plugged() const { return plugged_; }
  [[nodiscard]] std::size_t in_flight(direction towards) const; ///< octets
  [[nodiscard]] const line_counters& counters(direction towards) const;

private:
  struct written_chunk {
    payload octets;
    instant due;
    provenance from = {};
  };

  struct lane_state {
    std::deque<written_chunk> chunks; ///< in order of arrival; bounded by the buffer
    instant free_at{};                ///< when the last octet written so far has left
    line_counters counters;
  };

  [[nodiscard]] lane_state& of(direction towards);
  [[nodiscard]] std::size_t room(const lane_state& x, instant now) const;
  [[nodiscard]] payload carry(payload octets, std::size_t accepted, line_counters& counters);

  line_config config_;
  random_stream rng_;
  std::array<lane_state, 2> lanes_;
  bool plugged_ = true;
};

} // namespace rubicon::serial
