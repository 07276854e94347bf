// Messages of channels on their way to the next mote: those that wait for the radio, and the one
// that it has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "network/channels/channel_message.hpp"

namespace rubicon::network {

/// When a packet may leave; matters in its first round only, all others wait for their turn.
enum class departure : std::uint8_t {
  in_turn, ///< see network/turns.hpp
  at_once, ///< the next mote expects it
  in_slot, ///< no mote near sends now: the first hop needs no back-off
};

/// Hand this frame of AM type am::channel to the radio and notify on_sent() how it ended.
struct channel_hop {
  mote_id next; ///< broadcast_mote: to all
  bytes octets;
  bool in_slot = false; ///< as in radio::request
  provenance from = {};
};

/// A message, and how often the radio has had it.
struct waiting_hop {
  mote_id next;
  channel_message message;
  unsigned rounds = 0;
  instant due;
  departure how = departure::in_turn;
  provenance from = {};
};

[[nodiscard]] inline bool is_data(const channel_message& x) {
  return std::holds_alternative<data_message>(x.content);
}

/// Bounded: packets and their octets; of control messages, which are few and matter more, as many
/// again find room. What finds none is dropped. The radio has one message at a time.
class hop_queue {
public:
  enum class outcome : std::uint8_t {
    queued,
    repeated,    ///< the same end of a channel waits already
    lost,        ///< no room for a packet
    crowded_out, ///< nor for a control message
  };

  hop_queue() = default;
  hop_queue(std::size_t packets_max, std::size_t octets_max)
      : packets_max_(packets_max), octets_max_(octets_max) {}

  /// For another packet of so many octets.
  [[nodiscard]] bool has_room(std::size_t octets) const;

  outcome add(mote_id next, channel_message message, instant due, departure how);

  /// Until then only what departs at once or in a slot leaves, each in its first round.
  void hold(instant until) { held_until_ = until; }

  /// Hands out what is due. Nothing: there is nothing, or the radio has something.
  [[nodiscard]] std::optional<channel_hop> take(instant now);

  /// What the radio had, with its rounds. Nothing: it had nothing.
  [[nodiscard]] std::optional<waiting_hop> on_sent();

  /// Before all others, again.
  void repeat(waiting_hop x, instant due);

  /// The channel is no more: what waits for it is lost.
  void drop(channel_id channel);
  void drop_flood(channel_id channel);

  /// When take() hands something out.
  [[nodiscard]] std::optional<instant> deadline() const;

private:
  [[nodiscard]] instant due(const waiting_hop& x) const;

  std::size_t packets_max_ = 0;
  std::size_t octets_max_ = 0;
  std::vector<waiting_hop> waiting_;
  std::optional<waiting_hop> in_flight_;
  instant held_until_;
};

} // namespace rubicon::network
