// The channels of one mote, and their messages on the way to its neighbours.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "network/channels/channel_message.hpp"
#include "network/channels/channels_output.hpp"
#include "network/channels/flood_offers.hpp"
#include "network/channels/hop_queue.hpp"
#include "network/channels/next_mote.hpp"

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

  /// A flood is forwarded within flood_spread; in a crowd not if enough copies came before.
  duration flood_spread = 60ms;

  std::uint8_t hops_max = 32;
  std::size_t tries_max = 3; ///< neighbours, at each mote, before a set-up goes back
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

/// Each mote on a channel's path hands a scheduled packet on so much later than it gets it: medium
/// access, a frame of the longest size, and a repeat (NRG-03).
inline constexpr std::chrono::microseconds channel_slot{10'000};

/// A channel that begins, passes or ends here, or is being set up. No more than `tries_max`
/// tried.
struct channel_entry : connect_step {
  std::optional<mote_id> next; ///< nothing at the destination, and while it is looked for
  bool open = false;
  unsigned losses = 0;                       ///< packets in a row that `next` has not acknowledged
  std::uint8_t sent = 0;                     ///< sequence number of our last packet, at an end
  std::optional<std::uint8_t> from_previous; ///< sequence number of the last packet from there
  std::optional<std::uint8_t> from_next;
  instant last_packet;
  instant setup_end;
  std::optional<instant> look_end; ///< it waits, or has waited, so long for a neighbour
  bool flooded = false;            ///< by us
  flood_copies heard;

  [[nodiscard]] bool is_looking() const { return look_end && !next && !open && !flooded; }
};

/// What happens at a mote is handled at this moment, in these surroundings; outputs are appended.
struct channel_occasion {
  const surroundings& around;
  channels_outputs& out;
  instant now;
};

/// What setting up and using channels share. Bounded: entries_max.
class channel_table {
public:
  channel_table() = default;
  explicit channel_table(const channels_config& config)
      : config_(config), queue_(config.queue_max, config.octets_max) {}

  [[nodiscard]] const channels_config& config() const { return config_; }
  [[nodiscard]] channels_counters& counters() { return counters_; }
  [[nodiscard]] const channels_counters& counters() const { return counters_; }
  [[nodiscard]] hop_queue& waiting() { return queue_; }
  [[nodiscard]] const hop_queue& waiting() const { return queue_; }

  [[nodiscard]] bool is_full() const { return entries_.size() >= config_.entries_max; }
  /// Ascending (NET-02).
  [[nodiscard]] const std::map<channel_id, channel_entry>& all() const { return entries_; }
  /// nullptr: no such channel is here.
  [[nodiscard]] channel_entry* find(channel_id channel);
  [[nodiscard]] const channel_entry* find(channel_id channel) const;
  /// The same, if the mote is the next or the previous one on its path.
  [[nodiscard]] channel_entry* find_by(channel_id channel, mote_id neighbour);

  channel_entry& add(channel_id channel) { return entries_[channel]; } ///< @pre !is_full()
  void erase(channel_id channel) { entries_.erase(channel); }

  /// Frees what the channel holds here and notifies its neighbours on the path, but not
  /// `informed_by`.
  void free(channel_id channel, channel_end why, std::optional<mote_id> informed_by,
            channels_outputs& out, instant now);

  /// A packet comes here as much later as its route to us takes (NRG-03).
  static void reserve(channel_id channel, const channel_entry& x, channels_outputs& out);

  void queue(mote_id next, channel_message message, instant due,
             departure how = departure::in_turn);

  /// Hands the radio the next message, if it has none.
  void pump(channels_outputs& out, instant now);

private:
  channels_config config_;
  std::map<channel_id, channel_entry> entries_;
  hop_queue queue_;
  channels_counters counters_;
};

} // namespace rubicon::network
