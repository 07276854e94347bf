// The Network module of one node: what links there are, the tree, coordinates, the clock, packets
// up, down and to all, and channels (D1.1 3.3.3.1, GEN-08).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "network/beacon.hpp"
#include "network/channels/channels.hpp"
#include "network/channels/known_places.hpp"
#include "network/channels/place_questions.hpp"
#include "network/frames/direct_packets.hpp"
#include "network/frames/outgoing_frames.hpp"
#include "network/own_beacons.hpp"
#include "network/places/coordinates.hpp"
#include "network/places/place_reports.hpp"
#include "network/router_config.hpp"
#include "network/router_message.hpp"
#include "network/router_output.hpp"
#include "network/time_sync.hpp"
#include "network/tree/collection.hpp"
#include "network/tree/gradient.hpp"
#include "network/tree/neighbours.hpp"
#include "network/tree/route_help.hpp"
#include "network/turns.hpp"

namespace rubicon::network {

struct router_counters {
  std::uint64_t beacons = 0;
  std::uint64_t malformed = 0;    ///< frames that could not be decoded
  std::uint64_t unknown_type = 0; ///< frames of an AM type that is not Network's
  std::uint64_t questions = 0;    ///< where a mote is
  std::uint64_t unanswered = 0;
  std::uint64_t detours = 0;         ///< packets for a neighbour that went by the sink after all
  std::uint64_t asks = 0;            ///< beacons that ask for the time
  std::uint64_t answers = 0;         ///< to those of others
  std::uint64_t disputes = 0;        ///< stamps that did not fit what was known
  std::uint64_t silences = 0;        ///< no answer came any more: the time was distrusted
  std::uint64_t period_requests = 0; ///< for more rounds of the clock
  std::uint64_t sequence_requests = 0;
  std::uint64_t beside_backbone = 0; ///< frames received by radio from the other end of a backbone
};
RUBICON_FIELDS(router_counters, beacons, malformed, unknown_type, questions, unanswered, detours,
               asks, answers, disputes, silences, period_requests, sequence_requests,
               beside_backbone);

/// Longest content for all.
[[nodiscard]] std::size_t room_to_all();

/// One frame of each kind is in flight at a time: beacon, packet, channel message; packets for
/// neighbours several. Where synaptic vectors have slots, all others keep to their turns.
class router {
public:
  router() = default;
  router(router_config config, random_stream rng, instant now);

  /// Longest content for a destination: what its route leaves room for. Nothing: no route is known.
  [[nodiscard]] std::optional<std::size_t> room_to(mote_id destination) const;
  /// Towards a mote of the island, or the sink. A mote that is no neighbour is reached through
  /// the sink, which gets the content and must send it down.
  /// @param in_slot no mote near sends now: the first hop needs no back-off
  /// @pre room_to() is given and content fits
  [[nodiscard]] router_outputs send(mote_id destination, bytes content, instant now,
                                    bool in_slot = false);
  [[nodiscard]] router_outputs send_to_all(bytes content, instant now);

  /// D1.1 3.3.3.1 connect: the id at once, channel_connected or channel_ended later.
  [[nodiscard]] std::pair<channel_id, router_outputs>
  connect(mote_id destination, const channel_schedule& schedule, duration expiry, instant now);
  /// @returns nothing if the channel is not open here or its queue is full
  [[nodiscard]] std::optional<router_outputs> send_on(channel_id channel, bytes content,
                                                      departure how, instant now);
  [[nodiscard]] router_outputs disconnect(channel_id channel, instant now);
  /// A channel that was accepted is not wanted: its source is notified of no_room.
  [[nodiscard]] router_outputs refuse(channel_id channel, instant now);

  /// @param sfd when the frame's start-of-frame delimiter was received; of one that a backbone has
  /// carried, when it was sent
  [[nodiscard]] router_outputs on_frame(mote_id source, std::uint8_t am_type, byte_view payload,
                                        instant sfd, instant now, medium over = medium::radio);
  [[nodiscard]] router_outputs on_sent(std::uint64_t token, bool acked, unsigned transmissions,
                                       instant now);
  [[nodiscard]] router_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] instant deadline() const;

  /// Motes of the island send synaptic vectors in so many slots, the first ones; all others learn
  /// it. @pre is_sink
  void use_slots(std::size_t count, instant now);

  /// The longest wait of a frame for its turn; and, where radios listen at low power, for a channel
  /// that another's copies occupy, and for its receiver.
  [[nodiscard]] duration turn_wait(instant now) const {
    return turns_.longest(now, clock()) + 2 * config_.wake;
  }

  [[nodiscard]] const time_estimate& clock() const { return time_.time(); }
  [[nodiscard]] clock_sync& sync() { return time_.clock(); }
  [[nodiscard]] const time_search& search() const { return time_.search(); }
  [[nodiscard]] const neighbours& links() const { return links_; }
  [[nodiscard]] const gradient& tree() const { return tree_; }
  [[nodiscard]] const coordinates& place() const { return places_.own(); }
  [[nodiscard]] const collection& packets() const { return packets_; }
  [[nodiscard]] const channels& paths() const { return paths_; }
  [[nodiscard]] const router_counters& counters() const { return counters_; }

  /// Octets of all state on a mote with the default tables (SMP-30).
  [[nodiscard]] std::size_t footprint() const;

private:
  void keep_turns(instant now);
  void send_directs(router_outputs& out, instant now);
  void on_beacon(mote_id source, byte_view payload, instant sfd, router_outputs& out, instant now);
  void update_routes(router_outputs& out, instant now);
  void request_sequence(mote_id neighbour, router_outputs& out, instant now);
  [[nodiscard]] bool is_in_crowd() const;
  void hurry(instant now);
  /// @param again it says nothing that the last one did not: it counts as the same
  void send_beacon(router_outputs& out, instant now, bool again = false, bool asks = false);
  [[nodiscard]] std::optional<instant> report_due() const;
  void report(router_outputs& out, instant now);
  void take(collection_outputs todo, router_outputs& out, instant now);
  void take(channels_outputs todo, router_outputs& out);
  void on_content(collected x, router_outputs& out, instant now);
  void on_answer(const place_answer& x, router_outputs& out, instant now);
  void send_router_message(mote_id to, const router_message& x, router_outputs& out, instant now,
                           bool in_slot = false);
  [[nodiscard]] duration answer_wait(instant now) const;
  void search_time(router_outputs& out, instant now);
  void request_period(router_outputs& out, instant now);
  void on_stamp(const clock_stamp& x, instant sfd, router_outputs& out, instant now);
  void ask(mote_id destination, router_outputs& out, instant now);
  void begin_overdue(router_outputs& out, instant now);
  void begin(const awaited_channel& x, std::optional<virtual_coordinates> place,
             router_outputs& out, instant now);
  [[nodiscard]] surroundings around(instant now) const;

  own_router_config config_;
  random_stream rng_;
  instant started_;
  neighbours links_;
  gradient tree_;
  route_help help_;
  own_beacons beacons_;
  time_sync time_;
  known_places places_;
  place_reports reports_;
  place_questions questions_;
  collection packets_;
  channels paths_;
  turns turns_;
  instant turn_; ///< frames without a slot wait until then
  outgoing_frames frames_;
  direct_packets directs_;
  router_counters counters_;
};

} // namespace rubicon::network
