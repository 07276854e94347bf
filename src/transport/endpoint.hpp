// Connectionless messages end to end: acknowledgement, retries, duplicate suppression (MCK-09..12).
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/random.hpp"
#include "core/time.hpp"
#include "transport/segment.hpp"

namespace rubicon::transport {

/// Names one send to its owner, who chooses it.
using ticket = std::uint64_t;

/// Hand this segment to Network.
struct to_network {
  mote_address destination;
  std::uint16_t channel = 0; ///< equals the AM type (WIR-01)
  bytes segment;
};

/// A message for the process that owns its AM type.
struct received {
  mote_address source; ///< no_mote in the mote part: a PC or robot
  std::uint8_t am_type = 0;
  bytes payload;
};

/// How a reliable send ended; exactly one per accepted reliable send.
struct outcome {
  ticket id = 0;
  bool acked = false;
};

using output = std::variant<to_network, received, outcome>;
using outputs = std::vector<output>;

struct endpoint_config {
  mote_id self;                    ///< no_mote for the PC side
  duration ack_wait = 500ms;       ///< after the first attempt; doubles with each further one
  unsigned attempts_max = 5;       ///< failure after 31 times ack_wait
  std::size_t outstanding_max = 8; ///< reliable sends waiting for their acknowledgement
  std::size_t sources_max = 64;    ///< senders remembered for duplicate suppression
  std::size_t sequences_per_source = 16;
};

struct endpoint_counters {
  std::uint64_t reliable_sent = 0; ///< accepted
  std::uint64_t reliable_acked = 0;
  std::uint64_t reliable_failed = 0;
  std::uint64_t unreliable_sent = 0;
  std::uint64_t refused = 0; ///< bad destination, too long, or too many outstanding
  std::uint64_t retries = 0;
  std::uint64_t received = 0;
  std::uint64_t duplicates = 0; ///< acknowledged again, not passed up
  std::uint64_t malformed = 0;
  std::uint64_t stray_acks = 0; ///< for nothing that is outstanding
};

/// One end of connectionless messaging, on a mote or on the PC side of a gateway. A reliable
/// message is repeated with its sequence number until the other end's endpoint acknowledges it.
class endpoint {
public:
  endpoint() = default;

  /// The first sequence number comes from `dice`, so that a rebooted node's messages are not taken
  /// for repeats of its earlier life.
  endpoint(endpoint_config config, random_stream dice);

  /// Accepts a message of at most payload_max octets, or refuses it (nothing) at once: too long,
  /// reliable to broadcast, or outstanding_max reached.
  [[nodiscard]] std::optional<outputs> send(ticket id, mote_address destination,
                                            std::uint8_t am_type, bytes payload, bool reliable,
                                            instant now);

  /// A segment from `source_island` has arrived.
  [[nodiscard]] outputs on_segment(island_id source_island, byte_view octets, instant now);

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Ends every outstanding send as failed, as when the node leaves its island.
  [[nodiscard]] outputs fail_all();

  [[nodiscard]] std::size_t outstanding() const { return waiting_.size(); }
  [[nodiscard]] const endpoint_counters& counters() const { return counters_; }

private:
  struct waiting {
    ticket id = 0;
    mote_address destination;
    segment content;
    unsigned attempts = 1;
    instant due;
  };

  struct history {
    mote_address source;
    std::deque<std::uint16_t> sequences;
  };

  [[nodiscard]] to_network wrap(mote_address destination, const segment& x) const;
  [[nodiscard]] bool seen_before(mote_address source, std::uint16_t sequence);
  [[nodiscard]] outputs on_acknowledgement(mote_address source, std::uint16_t sequence);

  endpoint_config config_;
  std::uint16_t next_sequence_ = 0;
  std::deque<waiting> waiting_; ///< in order of sending
  std::deque<history> heard_;   ///< most recently heard last
  endpoint_counters counters_;
};

} // namespace rubicon::transport
