// Channels: connections over several hops that reserve what they need at each mote on their path
// (D1.1 3.3.3.1; NET-01..10, NET-12, NRG-01).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "network/channels/channel_message.hpp"

namespace rubicon::network {

struct channels_config {
  mote_id self;
  std::size_t entries_max = 8; ///< channels that begin, pass or end here
  std::size_t offers_max = 3;  ///< floods of connect messages that we may come to be part of
  std::size_t queue_max = 4;   ///< packets that wait for the radio; control messages: as many again
  std::size_t octets_max = 216; ///< of the content of packets that wait or are in flight
  unsigned rounds_max = 6;      ///< times a control message is handed to the radio
  /// And a packet; the radio itself tries four times (NET-05), but once in a slot: that round is
  /// not counted.
  unsigned data_rounds_max = 2;
  /// Packets in a row that the next mote does not acknowledge: the path is broken.
  unsigned losses_max = 4;
  duration round_pause = 30ms;    ///< between rounds, up to twice as long
  duration connect_timeout = 10s; ///< until the source gives up, beside what frames wait
  static constexpr duration setup_timeout = 12s; ///< until a mote on the path does, likewise
  duration wake{};                               ///< access_times::wake

  /// A flood is forwarded within flood_spread; in a crowd not if so many copies came before.
  duration flood_spread = 60ms;
  static constexpr unsigned flood_copies = 3;

  std::uint8_t hops_max = 32;
  std::size_t tries_max = 3; ///< neighbours, at each mote, before a set-up goes back
  static constexpr std::size_t dead_ends_max = 3; ///< set-ups that are refused when they come again
};

struct channels_counters {
  std::uint64_t connects = 0; ///< as source
  std::uint64_t connected = 0;
  std::uint64_t accepted = 0; ///< as destination
  std::uint64_t backtracks = 0;
  std::uint64_t floods = 0; ///< begun here; over connects: the share of fallbacks (NET-12), since
  std::uint64_t floods_place_unknown = 0; ///< no mote had reported where the destination is,
  std::uint64_t floods_self_unknown = 0;  ///< or we did not know where we are,
  std::uint64_t floods_dead_end = 0;      ///< or no neighbour was nearer, of those that answered
  std::uint64_t broken = 0;               ///< next or previous mote did not answer
  std::uint64_t expired = 0;
  std::uint64_t refused = 0;      ///< no room here
  std::uint64_t packets_sent = 0; ///< from this end
  std::uint64_t packets_forwarded = 0;
  std::uint64_t packets_received = 0; ///< at this end
  std::uint64_t packets_lost = 0;     ///< here: no more rounds, or the queue was full
  std::uint64_t duplicates = 0;       ///< packets again, their acknowledgement was lost
  std::uint64_t crowded_out = 0;      ///< control messages that found no room in the queue
  std::uint64_t strays = 0;           ///< for channels that do not pass here
  std::uint64_t malformed = 0;
};
RUBICON_FIELDS(channels_counters, connects, connected, accepted, backtracks, floods,
               floods_place_unknown, floods_self_unknown, floods_dead_end, broken, expired, refused,
               packets_sent, packets_forwarded, packets_received, packets_lost, duplicates,
               crowded_out, strays, malformed);

/// A good neighbour, and where it is if that is known.
struct nearby_mote {
  mote_id mote;
  std::optional<virtual_coordinates> place;
};

/// What greedy forwarding knows of the surroundings.
struct surroundings {
  std::optional<virtual_coordinates> own_place;
  std::vector<nearby_mote> motes; ///< good neighbours (NET-10)
  std::vector<nearby_mote> heard; ///< other neighbours, of whose links too little is known
  mote_id parent = no_mote;       ///< in the tree
  bool is_crowd = false;          ///< there may be more than the table of neighbours holds
  bool is_new = false;            ///< we have started lately: more neighbours may be there
  duration beacon_wait = 1s;      ///< within which neighbours beacon that have just started, or see
                                  ///< that we have
  duration turn_wait{};           ///< that a frame may have to wait before it leaves, at each hop
};

/// Each mote on a channel's path hands a scheduled packet on so much later than it gets it: medium
/// access, a frame of the longest size, and a repeat (NRG-03).
inline constexpr std::chrono::microseconds channel_slot{10'000};

/// Hand this frame of AM type am::channel to the radio and notify on_sent() how it ended.
struct channel_hop {
  mote_id next; ///< broadcast_mote: to all
  bytes octets;
  bool in_slot = false; ///< as in radio::request
  provenance from = {};
};

/// As source: the channel is open.
struct channel_connected {
  channel_id channel;
};

/// As destination: somebody has opened a channel to us.
struct channel_accepted {
  channel_id channel;
};

struct channel_received {
  channel_id channel;
  bytes content;
};

/// The channel is gone, at source or destination; also when it never came to be.
struct channel_ended {
  channel_id channel;
  channel_end why = channel_end::broken;
};

/// At any mote on the path: the radio is needed at these times, or no longer (schedule.interval 0).
struct channel_reserved {
  channel_id channel;
  /// `first` is when a packet comes here, at the source when it leaves.
  channel_schedule schedule;
  std::optional<mote_id> previous = {}; ///< who it comes from; nothing at the source
};

/// When a packet may leave; matters in its first round only, all others wait for their turn.
enum class departure : std::uint8_t {
  in_turn, ///< see network/turns.hpp
  at_once, ///< the next mote expects it
  in_slot, ///< no mote near sends now: the first hop needs no back-off
};

using channels_output = std::variant<channel_hop, channel_connected, channel_accepted,
                                     channel_received, channel_ended, channel_reserved>;
using channels_outputs = std::vector<channels_output>;

/// The connect message goes greedily towards the destination's coordinates. At a dead end it goes
/// back one mote, which sends it to another neighbour, and after `tries_max` of them back in turn;
/// the source then waits once for a neighbour that has just started and tries again, and at last
/// floods. Each mote on the path keeps previous and next hop, and refuses for a while what
/// it has sent back.
///
///   source: connecting --connect-ack--> open --disconnect--> gone
///              |                          |
///              +--refused, time-out-------+--broken, expired--> ended
class channels {
public:
  channels() = default;
  channels(channels_config config, random_stream rng);

  /// A name for a channel that this mote will open (NET-01).
  [[nodiscard]] channel_id next_id() { return {config_.self, next_number_++}; }

  /// channel_connected or channel_ended comes later; at once, if there is no room here.
  /// @param channel of next_id()
  /// @param place of the destination; nothing: it is looked for everywhere
  /// @param expiry the channel ends if no packet comes for so long, whole seconds; 0: never
  [[nodiscard]] channels_outputs connect(channel_id channel, mote_id destination,
                                         std::optional<virtual_coordinates> place,
                                         const channel_schedule& schedule, duration expiry,
                                         const surroundings& around, instant now);

  /// From source to destination, or from destination to source: streams are answered that way.
  /// @pre content.size() <= channel_packet_max. @returns nothing: no end of such an open channel is
  /// here, or there is no room in the queue
  [[nodiscard]] std::optional<channels_outputs> send(channel_id channel, bytes content,
                                                     departure how, instant now);

  /// Until then only packets in slots, and those that pass here, are handed out, each once: a
  /// vector has one tick for all its hops.
  void hold(instant until) { held_until_ = until; }

  /// From either end; the other end is notified.
  [[nodiscard]] channels_outputs disconnect(channel_id channel, instant now);

  /// The destination wants no such channel: the source is notified of no_room.
  [[nodiscard]] channels_outputs refuse(channel_id channel, instant now);

  [[nodiscard]] channels_outputs on_frame(mote_id from, byte_view octets,
                                          const surroundings& around, instant now);

  /// The last channel_hop has ended. @param around matters only if it was not acknowledged
  [[nodiscard]] channels_outputs on_sent(bool acked, const surroundings& around, instant now);

  /// A neighbour has begun anew: it knows of no channel.
  [[nodiscard]] channels_outputs on_restarted(mote_id neighbour, const surroundings& around,
                                              instant now);

  /// Whether a set-up waits for a neighbour: then look() is due with each beacon, and at
  /// deadline().
  [[nodiscard]] bool is_looking() const;
  /// @param heard whose beacon has come: even if it has led nowhere before
  [[nodiscard]] channels_outputs look(std::optional<mote_id> heard, const surroundings& around,
                                      instant now);

  [[nodiscard]] channels_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  /// A packet that arrives has been in flight for no longer (IF-05). At each hop it may need all
  /// its rounds, waits for those that its queue holds before it, which need one try each, and once
  /// for the radio of the next mote if that sleeps.
  /// @returns nothing: no end of such an open channel is here
  [[nodiscard]] std::optional<duration> latency_bound(channel_id channel) const;

  /// Of the whole path. @returns nothing: the channel is not open here
  [[nodiscard]] std::optional<std::uint8_t> hops(channel_id channel) const;

  /// Channels that begin, pass or end here, ascending (NET-02).
  [[nodiscard]] std::vector<channel_id> table() const;
  [[nodiscard]] const channels_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t footprint() const {
    // one that waits: next hop, kind, channel, sequence, rounds, when it is due
    return config_.entries_max * (36 + 2 * config_.tries_max) + config_.offers_max * 12 +
           config_.dead_ends_max * 6 + config_.octets_max + (2 * config_.queue_max + 1) * 12 + 16;
  }

private:
  /// Of a flooded connect message that we have said, too.
  struct flood_copies {
    unsigned copies = 1;    ///< received
    bool passed_on = false; ///< one of them by a mote that had it from us, or might have
  };

  struct entry {
    std::optional<mote_id> previous; ///< nothing at the source
    std::optional<mote_id> next;     ///< nothing at the destination, and while it is looked for
    bool open = false;
    connect_message request;    ///< as it came to us; once open, with the hops of the path
    std::vector<mote_id> tried; ///< no more than `tries_max`: were a dead end, or did not answer
    unsigned losses = 0;        ///< packets in a row that `next` has not acknowledged
    std::uint8_t sent = 0;      ///< sequence number of our last packet, at an end
    std::optional<std::uint8_t> from_previous; ///< sequence number of the last packet from there
    std::optional<std::uint8_t> from_next;
    instant last_packet;
    instant setup_end;
    std::optional<instant> look_end; ///< it waits, or has waited, so long for a neighbour
    bool flooded = false;            ///< by us
    flood_copies heard;

    [[nodiscard]] bool has_tried(mote_id x) const {
      return std::ranges::find(tried, x) != tried.end();
    }
    [[nodiscard]] bool is_looking() const { return look_end && !next && !open && !flooded; }
  };

  /// A flooded connect message that was received first from `previous`.
  struct offer {
    mote_id previous;
    connect_message request;
    instant end;
    flood_copies heard;
  };

  /// A set-up that we have sent back, and refuse.
  struct dead_end {
    channel_id channel;
    instant until;
  };

  struct waiting {
    mote_id next;
    channel_message message;
    unsigned rounds = 0;
    instant due;
    departure how = departure::in_turn;
    provenance from = {};
  };

  void queue(mote_id next, channel_message message, instant due,
             departure how = departure::in_turn);
  [[nodiscard]] instant due(const waiting& x) const;
  [[nodiscard]] bool has_room(std::size_t octets) const;
  void pump(channels_outputs& out, instant now);
  void go_on(channel_id id, entry& x, const surroundings& around, channels_outputs& out,
             instant now);
  [[nodiscard]] static std::optional<mote_id> nearer(const entry& x, const surroundings& around);
  [[nodiscard]] static std::optional<mote_id> nearest(const entry& x,
                                                      const std::vector<nearby_mote>& among,
                                                      const surroundings& around,
                                                      std::uint32_t slack);
  [[nodiscard]] static bool waits(entry& x, const surroundings& around, instant now);
  [[nodiscard]] static bool may_be_near(const entry& x, const surroundings& around);
  [[nodiscard]] bool is_dead_end(channel_id id) const;
  void note_dead_end(channel_id id, instant until);
  void flood(channel_id id, entry& x, const surroundings& around, instant now);
  static void note_copy(flood_copies& x, std::uint8_t hops, std::uint8_t own_hops);
  void end_flood(channel_id id);
  [[nodiscard]] unsigned rounds_of_flood(channel_id id) const;
  void free(channel_id id, channel_end why, std::optional<mote_id> informed_by,
            channels_outputs& out, instant now);
  void reserve(channel_id id, const entry& x, channels_outputs& out) const;
  void on_lost(const waiting& x, const surroundings& around, channels_outputs& out, instant now);

  void take(mote_id from, channel_id id, connect_message& x, const surroundings& around,
            channels_outputs& out, instant now);
  void take_flooded(mote_id from, channel_id id, const connect_message& x,
                    const surroundings& around, channels_outputs& out, instant now);
  void take(mote_id from, channel_id id, connect_ack_message& x, const surroundings& around,
            channels_outputs& out, instant now);
  void take(mote_id from, channel_id id, end_message& x, const surroundings& around,
            channels_outputs& out, instant now);
  void take(mote_id from, channel_id id, dead_end_message& x, const surroundings& around,
            channels_outputs& out, instant now);
  void take(mote_id from, channel_id id, data_message& x, const surroundings& around,
            channels_outputs& out, instant now);

  channels_config config_;
  random_stream rng_;
  std::uint16_t next_number_ = 0;
  std::map<channel_id, entry> entries_;
  std::map<channel_id, offer> offers_;
  std::vector<dead_end> dead_ends_; ///< the oldest first
  std::vector<waiting> queue_;
  std::optional<waiting> in_flight_;
  instant held_until_;
  channels_counters counters_;
};

} // namespace rubicon::network
