// Connectionless messages end to end: order, acknowledgement, repeats, suppression of duplicates,
// flow control (MCK-09..12, MCK-18).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "transport/answer_slack.hpp"
#include "transport/segment.hpp"

namespace rubicon::transport {

/// Names one send to its owner, who chooses it.
using ticket = std::uint64_t;

/// Hand this segment to Network.
struct to_network {
  mote_address destination;
  std::uint16_t channel = 0; ///< equals the AM type (WIR-01)
  bytes segment;
  bool in_slot = false; ///< never of messenger's: no node near sends now
  provenance from = {};
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

struct messenger_config {
  mote_id self;                  ///< no_mote for the PC side
  std::uint32_t incarnation = 0; ///< how often this node has been started before
  duration ack_wait = 500ms;     ///< after the first attempt; doubles with each further one,
  answer_slacks slacks = {};     ///< and this more after each, but for a mote's own island: as
                                 ///< set_answer_slack() has it
  static constexpr unsigned attempts_max = 5; ///< failure after 31 times ack_wait
  /// No attempt waits less than twice as long as answers of that receiver take, up to this: a slow
  /// line is not filled with copies of what it still holds. It fails no later for that: there are
  /// fewer attempts then.
  static constexpr duration answer_wait_max = 8s;
  static constexpr duration busy_wait = 500ms; ///< before a receiver without room is asked again
  std::size_t payload_max = transport::payload_max; ///< of a message
  std::size_t outstanding_max = 8;                  ///< reliable sends that have not ended
  std::size_t sessions_max = 6;                     ///< receivers whose incarnation is remembered
  std::size_t sources_max = 8; ///< senders remembered for suppression of duplicates
  /// Nothing is in flight for longer, beside what answers take longer; then numbers prove nothing
  /// any more.
  duration lifetime = 60s;
};

struct messenger_counters {
  std::uint64_t reliable_sent = 0; ///< accepted
  std::uint64_t reliable_acked = 0;
  std::uint64_t reliable_failed = 0;
  std::uint64_t unreliable_sent = 0;
  std::uint64_t failed_unanswered = 0; ///< of those: no attempt was acknowledged
  std::uint64_t failed_refused = 0;    ///< the receiver was another incarnation by then
  std::uint64_t failed_no_program = 0; ///< no program of the receiver has their AM type
  std::uint64_t failed_left = 0;       ///< this node has left its island (fail_all)
  std::uint64_t refused = 0;         ///< sends: bad destination, too long, or too many outstanding
  std::uint64_t refused_crowded = 0; ///< of those: too many outstanding
  std::uint64_t retries = 0;
  std::uint64_t hellos = 0;
  std::uint64_t received = 0;
  std::uint64_t duplicates = 0; ///< not passed up
  std::uint64_t throttled = 0;  ///< answered with busy
  std::uint64_t strangers =
      0; ///< answered with refused: for another incarnation, or from an unknown source
  std::uint64_t no_program = 0; ///< answered so: reliable ones of AM types without a program here
  std::uint64_t malformed = 0;
  std::uint64_t stray_answers = 0; ///< to nothing that is in flight
};
RUBICON_FIELDS(messenger_counters, reliable_sent, reliable_acked, reliable_failed, unreliable_sent,
               failed_unanswered, failed_refused, failed_no_program, failed_left, refused,
               refused_crowded, retries, hellos, received, duplicates, throttled, strangers,
               no_program, malformed, stray_answers);

/// One end of connectionless messaging, on a mote or on the PC side of a gateway.
///
/// To each receiver one reliable message is in flight at a time, so they arrive in order. The first
/// one to a receiver is preceded by a hello, whose answer has the receiver's incarnation; the
/// message names it, and another incarnation refuses it: then it has failed, since the one before
/// may have had it. So a message is passed up at most once, whatever restarts, repeats or
/// overtakes.
class messenger {
public:
  messenger() = default;
  messenger(messenger_config config, random_stream rng);

  /// Where own_island is.
  void join(island_id island) { island_ = island; }

  /// Accepts a message of at most config.payload_max octets, or refuses it (nothing) at once: too
  /// long, reliable to broadcast, or outstanding_max reached.
  [[nodiscard]] std::optional<outputs> send(ticket id, mote_address destination,
                                            std::uint8_t am_type, bytes payload, bool reliable,
                                            instant now);

  /// Answers to what we send take so much longer from now on: our own radio, or those on the route,
  /// sleep.
  void set_answer_slack(duration x) { own_slack_ = x; }

  /// What answers from there take longer for radios that sleep.
  [[nodiscard]] duration slack_to(mote_address destination) const;
  /// Of it, what is not of our own island.
  [[nodiscard]] duration far_slack(mote_address destination) const;

  /// This node has been started again: greet it before the next message.
  void forget_incarnation(mote_address destination);

  /// Whoever owns this AM type has no room for reliable messages: their senders wait (MCK-18).
  void hold(std::uint8_t am_type) { held_.insert(am_type); }
  void release(std::uint8_t am_type) { held_.erase(am_type); }

  /// A segment from `source_island` has arrived.
  /// @param has_program whether a program here has that AM type: a reliable message of another one
  ///        is not acknowledged, and its sender learns why; empty: all are taken
  [[nodiscard]] outputs on_segment(island_id source_island, byte_view octets, instant now,
                                   const std::function<bool(std::uint8_t)>& has_program = {});

  [[nodiscard]] outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Ends every outstanding send as failed, as when the node leaves its island.
  [[nodiscard]] outputs fail_all();

  [[nodiscard]] std::size_t outstanding() const { return outstanding_; }
  [[nodiscard]] const messenger_config& config() const { return config_; }
  [[nodiscard]] const messenger_counters& counters() const { return counters_; }

  /// Octets of its state on a mote; payloads belong to their senders (AM-03).
  [[nodiscard]] std::size_t footprint() const {
    return config_.outstanding_max * 16 + config_.sessions_max * 12 + config_.sources_max * 9 + 48;
  }

private:
  struct message {
    ticket id = 0;
    std::uint8_t am_type = 0;
    bytes payload;
    provenance from = {};
  };

  /// What is in flight to one receiver.
  ///
  ///   greeting --acknowledged--> idle --message--> asking --acknowledged, failed--> idle
  ///      ^-------------------------+--refused---------+
  struct session {
    std::optional<incarnation> receiver; ///< nothing: it is being greeted
    std::uint16_t counter = 0;           ///< of the segment in flight, or of the last one
    std::vector<message> messages; ///< the first is in flight, unless it waits for the greeting
    unsigned attempts = 0; ///< more than one: an earlier copy may have arrived, without our knowing
    std::optional<instant> due; ///< of the next attempt; nothing: idle
    instant asked;              ///< the first attempt
    duration answer_wait{};     ///< for answers as slow as they were of late
    std::uint64_t used = 0;
  };

  struct source {
    incarnation sender = 0;
    std::uint16_t counter = 0; ///< of the last message passed up, or of the hello
    instant last_received;
    std::uint64_t used = 0;
  };

  [[nodiscard]] mote_address resolved(mote_address x) const;
  session& session_with(mote_address destination);
  void attempt(mote_address destination, session& x, outputs& out, instant now);
  void begin(mote_address destination, session& x, outputs& out, instant now);
  void end_first(mote_address destination, session& x, bool acked, outputs& out, instant now);
  void on_answer(mote_address from, const segment& x, outputs& out, instant now);
  void learn(mote_address from, session& x, instant now) const;
  [[nodiscard]] instant gives_up(mote_address destination, const session& x) const;
  void on_hello(mote_address from, const segment& x, outputs& out, instant now);
  void on_reliable(mote_address from, segment x, bool has_program, outputs& out, instant now);
  void answer(mote_address to, const segment& x, segment::kind what, outputs& out) const;

  messenger_config config_;
  duration own_slack_{};
  island_id island_ = own_island;
  std::uint16_t next_counter_ = 0; ///< of a new session: above those of sessions forgotten
  std::uint64_t uses_ = 0;
  std::size_t outstanding_ = 0;
  std::map<mote_address, session> sessions_;
  std::map<mote_address, source> sources_;
  std::set<std::uint8_t> held_;
  messenger_counters counters_;
};

} // namespace rubicon::transport
