// Channels: connections over several hops that reserve what they need at each mote on their path
// (D1.1 3.3.3.1; NET-01..10, NET-12, NRG-01).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "network/channels/channel_message.hpp"
#include "network/channels/channel_setup.hpp"
#include "network/channels/channel_table.hpp"
#include "network/channels/channels_output.hpp"
#include "network/channels/hop_queue.hpp"
#include "network/channels/next_mote.hpp"

namespace rubicon::network {

/// Sets channels up (channel_setup), carries packets over them, and ends those that are broken.
///
///   source: connecting --connect-ack--> open --disconnect--> gone
///              |                          |
///              +--refused, time-out-------+--broken, expired--> ended
class channels {
public:
  channels() = default;
  channels(channels_config config, random_stream rng);

  /// A name for a channel that this mote will open (NET-01).
  [[nodiscard]] channel_id next_id() { return {table_.config().self, next_number_++}; }

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
  void hold(instant until) { table_.waiting().hold(until); }

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
  [[nodiscard]] const channels_counters& counters() const { return table_.counters(); }
  [[nodiscard]] std::size_t footprint() const;

private:
  void take(mote_id from, channel_id id, const connect_message& x, const channel_occasion& at);
  void take(mote_id from, channel_id id, const connect_ack_message& x, const channel_occasion& at);
  void take(mote_id from, channel_id id, const end_message& x, const channel_occasion& at);
  void take(mote_id from, channel_id id, const dead_end_message& x, const channel_occasion& at);
  void take(mote_id from, channel_id id, data_message& x, const channel_occasion& at);
  void on_lost(const waiting_hop& x, const channel_occasion& at);

  random_stream rng_;
  std::uint16_t next_number_ = 0;
  channel_table table_;
  channel_setup setup_;
};

} // namespace rubicon::network
