// The backbone between an island's sink and a further one: a serial cable from each to a PC, which
// passes packets on from one to the other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "serial/cable/backbone_config.hpp"

namespace rubicon::serial {

/// Where a packet goes: up to the island's sink, or down to the further one.
enum class backbone_direction : std::uint8_t { up, down };

[[nodiscard]] constexpr backbone_direction opposite(backbone_direction x) {
  return x == backbone_direction::up ? backbone_direction::down : backbone_direction::up;
}

/// A packet of the Network module.
struct backbone_packet {
  std::optional<std::uint64_t> token; ///< nothing: to all, not acknowledged
  std::uint8_t am_type = 0;
  payload octets;
};

/// Give this packet to the end that it has reached.
struct backbone_arrived {
  backbone_direction to = backbone_direction::up;
  std::uint8_t am_type = 0;
  payload octets;
  duration
      age{}; ///< so long ago it was sent, as its receiver can know: wrong by jitter / 2 at most
  provenance from = {};
};

/// Notify the sender how it has ended.
struct backbone_done {
  backbone_direction to = backbone_direction::up; ///< of the packet
  std::uint64_t token = 0;
  bool acked = false;
  provenance from = {};
};

using backbone_output = std::variant<backbone_arrived, backbone_done>;
using backbone_outputs = std::vector<backbone_output>;

/// Packets in one direction: sent = arrived + overflow + cut + end_off + those in transit.
struct backbone_counters {
  std::uint64_t sent = 0;
  std::uint64_t arrived = 0;
  std::uint64_t overflow = 0; ///< lost at a full queue
  std::uint64_t cut = 0;      ///< lost because the backbone was cut
  std::uint64_t end_off = 0;  ///< reached a sink that was out of order
};
RUBICON_FIELDS(backbone_counters, sent, arrived, overflow, cut, end_off);

/// Two independent directions. Each carries packets one after the other: the octets of a packet at
/// the baud rate of the sender's cable, then again at that of the receiver's, the latency, and up
/// to the jitter more; none overtakes another. The receiver acknowledges a packet at once; the
/// acknowledgement takes the latency. Who has none after ack_wait takes the packet for lost.
class backbone {
public:
  static constexpr duration ack_wait = 100ms; ///< beyond the longest time there and back
  /// Octets of a TinyOS serial frame besides the payload (tinyos.md 1.1): two flags, protocol,
  /// sequence number, dispatch, header of eight, CRC.
  static constexpr std::size_t overhead = 15;

  backbone() = default;

  /// @pre config.baud > 0
  backbone(backbone_config config, random_stream rng) : config_(config), rng_(rng) {}

  void send(backbone_direction to, backbone_packet x, instant now);

  /// The sink that packets in this direction reach runs, or is out of order: then nobody waits any
  /// more for what it has sent, and its next life numbers packets anew.
  void set_end(backbone_direction to, bool on);

  /// Loses what is in transit, and what is sent until repair().
  /// @returns what had arrived by `now`
  [[nodiscard]] backbone_outputs cut(instant now);
  void repair() { is_cut_ = false; }

  [[nodiscard]] backbone_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] bool is_cut() const { return is_cut_; }
  [[nodiscard]] const backbone_counters& counters(backbone_direction to) const {
    return lanes_[static_cast<std::size_t>(to)].counters;
  }

private:
  struct transit {
    backbone_packet packet;
    duration age{};
    instant due;
    provenance from = {};
  };

  struct ending {
    backbone_done what;
    instant due;
  };

  struct one_direction {
    std::deque<transit> packets; ///< in order of arrival, queue at most
    instant free_at{};           ///< when the sender's cable is free again,
    instant last_due{};          ///< and the last packet arrives
    bool is_on = false;
    backbone_counters counters;
  };

  [[nodiscard]] one_direction& of(backbone_direction to) {
    return lanes_[static_cast<std::size_t>(to)];
  }
  void lose(backbone_direction to, const backbone_packet& x, const provenance& from, instant at);
  void end(backbone_done x, instant due);
  void arrive(backbone_direction to, backbone_outputs& out);

  backbone_config config_;
  random_stream rng_;
  std::array<one_direction, 2> lanes_;
  std::vector<ending> endings_; ///< by time: of those that a sender waits for
  bool is_cut_ = false;
};

} // namespace rubicon::serial
