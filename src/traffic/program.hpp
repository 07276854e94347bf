// Traffic that measures the medium access of motes: sender, relay and receiver of one mote.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "traffic/flow_config.hpp"
#include "traffic/packet_memory.hpp"
#include "traffic/part.hpp"
#include "traffic/schedule.hpp"

namespace rubicon::traffic {

/// AM type of measuring packets; no other program may have it.
inline constexpr std::uint8_t am_type = 0xf0;

/// What one mote does. At most one relay.
struct program_config {
  std::vector<sender_config> senders;
  std::optional<relay_config> relay;
  bool receives = false;

  [[nodiscard]] bool empty() const { return senders.empty() && !relay && !receives; }
};

/// A request to the MAC. Each must be answered with on_done().
struct transmit {
  std::uint64_t token = 0;
  mote_id next_hop;
  bytes payload; ///< AM payload: the MAC payload without network octet and AM type
  bool ack = true;
};

using outputs = std::vector<transmit>;

/// How a request ended, as the MAC reports it.
struct outcome {
  bool sent = false;      ///< acked, or put on the air if no ack was wanted
  bool arrived = false;   ///< the next hop has it, whether or not the sender knows
  std::string_view cause; ///< why not, if it has not arrived: a word of the report
  unsigned transmissions = 0;
};

/// Sans-I/O. A packet is counted as sent by its origin when it asks the MAC, as lost by whoever
/// asked the MAC for the hop on which it did not arrive, and as delivered by its target, once
/// however often it comes. A broadcast is delivered at each mote with a receiver, passed on by
/// nobody, and never lost.
///
/// A mote that has a packet and can do nothing with it counts it as lost: `queue_full` (open_max
/// requests are open), `aborted` (the power is off), `no_relay` or `no_receiver` (nobody here is
/// meant), `loop` (it has gone in a circle). A packet that came over the same hop before is dropped
/// without being counted again.
///
/// So for each flow to one mote, over all motes and all their lives: sent = delivered + sum of lost
/// + those still in flight.
///
/// An object is one life of a mote; the next life, after a loss of power, gets a new one. Numbers
/// and tokens of a later life are not those of an earlier one if the earlier made less than one
/// request a microsecond.
class program {
public:
  static constexpr std::size_t open_max = 1024;
  static constexpr std::size_t flows_max = 65536;

  program() = default;
  /// @param self flows end in the island they begin in
  /// @pre of each sender: payload in payload_min..payload_max, every > 0 unless it is saturated,
  /// jitter >= 0
  program(const program_config& config, mote_address self, random_stream rng);

  /// Once, before anything else.
  [[nodiscard]] outputs start(instant now);
  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()

  /// A frame that the MAC took for this mote or for all; none that was only overheard.
  /// @param source the last hop
  /// @param payload AM payload of a frame of type am_type; what does not decode is counted and
  /// dropped
  [[nodiscard]] outputs on_packet(mote_id source, byte_view payload, instant now);

  /// An unknown token is ignored.
  [[nodiscard]] outputs on_done(std::uint64_t token, const outcome& x, instant now);

  /// The mote has lost its power: requests that are open will not be answered and count as lost,
  /// `aborted`. Should one be answered after all, the answer is what counts.
  void stop(instant now);

  [[nodiscard]] std::optional<instant> deadline() const;

  /// What this mote knows about each flow it has a hand in, ascending by from, then to.
  [[nodiscard]] std::vector<part> parts(instant now) const;

  /// Requests without an answer yet.
  [[nodiscard]] std::size_t open() const { return open_.size(); }

  /// Packets dropped because they did not decode, or were of more flows than flows_max or more
  /// paths than packet_memory::paths_max.
  [[nodiscard]] std::uint64_t undecodable() const { return undecodable_; }

private:
  using flow_key = std::pair<mote_id, mote_id>; ///< origin, target

  struct sender {
    sender_config config;
    schedule times;
  };

  struct request {
    flow_key flow;
    std::optional<std::size_t> sender; ///< place in senders_; unset: relayed
    instant made;
  };

  [[nodiscard]] part& flow_of(flow_key key);
  void lose(flow_key key, std::string_view cause);
  void originate(std::size_t place, instant now, outputs& out);
  [[nodiscard]] bool submit(const request& x, transmit frame, outputs& out);
  [[nodiscard]] outputs relay(flow_key key, novelty news, byte_view payload, instant now);

  std::vector<sender> senders_;
  std::optional<relay_config> relay_;
  bool receives_ = false;
  mote_address self_;

  bool stopped_ = false;
  std::uint64_t next_number_ = 0;
  std::uint64_t next_token_ = 0;
  std::map<std::uint64_t, request> open_; ///< by token
  std::map<flow_key, part> flows_;
  packet_memory memory_;
  std::uint64_t undecodable_ = 0;
};

} // namespace rubicon::traffic
