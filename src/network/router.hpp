// The Network module of one node: what links there are, the tree, coordinates, the clock, packets
// up, down and to all, and channels (D1.1 3.3.3.1, GEN-08).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/small_map.hpp"
#include "core/time.hpp"
#include "network/beacon.hpp"
#include "network/channels/channels.hpp"
#include "network/channels/coordinates.hpp"
#include "network/channels/place_cache.hpp"
#include "network/clock/clock_sync.hpp"
#include "network/clock/time_search.hpp"
#include "network/router_message.hpp"
#include "network/tree/collection.hpp"
#include "network/tree/gradient.hpp"
#include "network/tree/neighbours.hpp"
#include "network/tree/trickle.hpp"
#include "network/turns.hpp"

namespace rubicon::network {

/// The ends of backbones: of a further sink the island's sink, of that all further ones. What is
/// sent to all goes over each backbone, too, and what is sent to one of these over its backbone
/// alone.
struct backbone_ends {
  std::vector<mote_id> motes;
  std::chrono::microseconds doubt{}; ///< how far the age of what comes may be wrong

  friend bool operator==(const backbone_ends&, const backbone_ends&) = default;
};

/// Of the router itself.
struct own_router_config {
  mote_id self;
  bool is_sink = false;
  std::uint8_t era = 0; ///< the sink's last one (clock_sync)
  tick_setting tick;    ///< the sink's (CLK-03)
  duty_window duty;     ///< when radios are on
  duration wake{};      ///< access_times::wake
  backbone_ends backbone;
  std::size_t questions_max = 2; ///< in flight: where a mote is
  duration relay_spread = 150ms; ///< a clock round is passed on within this time

  /// A mote reports its place to the sink at least so often, and so long after it has changed:
  /// twice as long with each further change.
  static constexpr duration report_period = 8min;
  static constexpr duration report_gap = 5s;

  /// The sink is asked where a mote is: wait for its answer, and requests until it answers. In a
  /// crowd, where floods are expensive, it is asked again when it does not know the place, or we do
  /// not know ours.
  static constexpr duration question_timeout = 3s;
  static constexpr unsigned asks_max = 2;
  static constexpr unsigned asks_in_crowd_max = 3;
  static constexpr duration question_gap = 5s;

  static constexpr std::size_t places_max = 1000;   ///< of motes, that the sink remembers
  static constexpr std::size_t places_kept = 6;     ///< that a mote learns from passing packets
  static constexpr duration place_lifetime = 10min; ///< of those
  static constexpr std::size_t direct_max = 4;      ///< packets for neighbours in flight

  /// A clock round is not passed on if so many copies of it have been received; else so often, with
  /// this pause where radios are always on.
  static constexpr unsigned relay_copies = 3;
  unsigned relays_max = 3;
  duration relay_pause = 1s;

  /// A beacon comes within this time of a change of coordinates, and as often from those that look
  /// for a route, but for no longer than seek_length; and for these not more often than help_gap.
  duration change_beacon = 1s;
  static constexpr duration seek_length = 30s;
  duration help_gap = 2s;

  /// Between requests for the sink's next sequence number, and, with two windows more, between its
  /// answers.
  duration sequence_gap = 20s;

  /// Who knows the time answers a request within answer_spread, unless others have. A window is
  /// short, and so is the time for which the other listens: the answer is repeated after
  /// answer_gap. Where radios are always on many may answer, and the other requests again.
  static constexpr duration answer_spread = 30ms;
  duration answer_spread_awake = 250ms;
  static constexpr unsigned answer_copies = 2;
  static constexpr duration answer_gap = 40ms;
  static constexpr unsigned answers_each = 2;
  duration answer_gap_awake = 1s;

  /// A mote whose unicasts fail in so many windows, and which receives nothing, doubts its time.
  static constexpr unsigned silent_windows_max = 3;

  /// Between requests for more clock rounds; each is sent within the spread, unless another mote's
  /// request was answered.
  static constexpr duration period_request_gap = 1min;
  static constexpr duration period_request_spread = 10s;
};

struct router_config : own_router_config {
  channels_config paths;     ///< sizes of tables and queues; a sink's are larger at least; the next
  collection_config packets; ///< too
  trickle_config beacons;
};

/// What carries a frame.
enum class medium : std::uint8_t { radio, backbone };

/// Nobody waits for the end of what has this token.
inline constexpr std::uint64_t no_token = std::numeric_limits<std::uint64_t>::max();

/// Put this frame on the radio, or on the backbone that leads to next_hop, and notify on_sent() how
/// it ended.
struct frame_out {
  std::uint64_t token = 0; ///< no_token: not to be acknowledged, on a backbone
  mote_id next_hop;        ///< broadcast_mote: to all, nobody acknowledges
  std::uint8_t am_type = 0;
  bytes payload;
  std::optional<std::size_t> age_at; ///< as in radio::request; the next too
  bool in_slot = false;
  medium over = medium::radio;
  provenance from = {};
};

/// For the user of Network at this node.
struct content_in {
  std::optional<mote_id> origin; ///< a mote of the island; nothing: what came down says itself
  bool to_all = false;
  bytes content;
};

/// The island's clock has been corrected, or is known now.
struct clock_corrected {};

using router_output =
    std::variant<frame_out, content_in, clock_corrected, channel_connected, channel_accepted,
                 channel_received, channel_ended, channel_reserved>;
using router_outputs = std::vector<router_output>;

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
  std::uint64_t silences = 0;        ///< nobody answered any more: the time was doubted
  std::uint64_t period_requests = 0; ///< for more rounds of the clock
  std::uint64_t sequence_requests = 0;
  std::uint64_t beside_backbone = 0; ///< frames received by radio from the other end of a backbone
};
RUBICON_FIELDS(router_counters, beacons, malformed, unknown_type, questions, unanswered, detours,
               asks, answers, disputes, silences, period_requests, sequence_requests,
               beside_backbone);

/// One frame of each kind is in flight at a time: beacon, packet, channel message; packets for
/// neighbours several. Where synaptic vectors have slots, all others keep to their turns.
class router {
public:
  router() = default;
  router(router_config config, random_stream rng, instant now);

  /// Longest content for a destination: what its route leaves room for. Nothing: no route is known.
  [[nodiscard]] std::optional<std::size_t> room_to(mote_id destination) const;
  [[nodiscard]] static std::size_t room_to_all();

  /// Towards a mote of the island, or the sink. A mote that is no neighbour is reached through
  /// the sink, which gets the content and must send it down.
  /// @param in_slot nobody near sends now: the first hop needs no back-off
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
  /// A channel that was accepted is not wanted: the source hears no_room.
  [[nodiscard]] router_outputs refuse(channel_id channel, instant now);

  /// @param sfd when the frame's start-of-frame delimiter was received; of one that a backbone has
  /// carried, when it was sent
  [[nodiscard]] router_outputs on_frame(mote_id source, std::uint8_t am_type, byte_view payload,
                                        instant sfd, instant now, medium over = medium::radio);
  [[nodiscard]] router_outputs on_sent(std::uint64_t token, bool acked, unsigned transmissions,
                                       instant now);
  [[nodiscard]] router_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] instant deadline() const;

  [[nodiscard]] static bool owns(std::uint8_t am_type);

  /// Motes of the island send synaptic vectors in so many slots, the first ones; all others learn
  /// it. @pre is_sink
  void use_slots(std::size_t count, instant now);

  /// The longest wait of a frame for its turn; and, where radios listen at low power, for a channel
  /// that another's copies occupy, and for its receiver.
  [[nodiscard]] duration turn_wait(instant now) const {
    return turns_.longest(now, clock_.time()) + 2 * config_.wake;
  }

  [[nodiscard]] bool has_route() const { return config_.is_sink || tree_.has_route(); }
  [[nodiscard]] const time_estimate& clock() const { return clock_.time(); }
  [[nodiscard]] clock_sync& sync() { return clock_; }
  [[nodiscard]] const time_search& search() const { return search_; }
  [[nodiscard]] const neighbours& links() const { return links_; }
  [[nodiscard]] const gradient& tree() const { return tree_; }
  [[nodiscard]] const coordinates& place() const { return place_; }
  [[nodiscard]] const collection& packets() const { return packets_; }
  [[nodiscard]] const channels& paths() const { return paths_; }
  [[nodiscard]] const router_counters& counters() const { return counters_; }

  /// Octets of all state on a mote with the default tables (SMP-30).
  [[nodiscard]] std::size_t footprint() const;

private:
  enum class purpose : std::uint8_t { beacon, packet, channel, direct };

  struct question {
    channel_id channel;
    mote_id destination;
    channel_schedule schedule;
    duration expiry{};
    instant due;
    unsigned asks = 0; ///< sent to the sink: none before there is a route to it
  };

  struct direct {
    mote_id to;
    bytes content;
    provenance from = {};
  };

  void keep_turns(instant now);
  [[nodiscard]] duration change_beacon() const;
  [[nodiscard]] duration spread_in_window() const;
  void send_directs(router_outputs& out, instant now);
  void on_beacon(mote_id source, byte_view payload, instant sfd, router_outputs& out, instant now);
  void settle(router_outputs& out, instant now);
  void feed(mote_id neighbour, router_outputs& out, instant now);
  [[nodiscard]] bool is_in_crowd() const;
  void hurry(instant now);
  [[nodiscard]] bool may_hasten(instant now);
  /// @param again it says nothing that the last one did not: it counts as the same
  void send_beacon(router_outputs& out, instant now, bool again = false, bool asks = false);
  [[nodiscard]] std::optional<instant> report_due() const;
  void report(router_outputs& out, instant now);
  void take(collection_outputs todo, router_outputs& out, instant now);
  void take(channels_outputs todo, router_outputs& out);
  void on_content(collected x, router_outputs& out, instant now);
  void send_router_message(mote_id to, const router_message& x, router_outputs& out, instant now,
                           bool in_slot = false);
  [[nodiscard]] duration answer_wait(instant now) const;
  [[nodiscard]] time_knowledge knowledge(instant now) const;
  void search_time(router_outputs& out, instant now);
  void on_stamp(const clock_stamp& x, instant sfd, router_outputs& out, instant now);
  void answer(const clock_stamp& x, instant now);
  void watch_silence(bool acked, instant now);
  void request_period(router_outputs& out, instant now);
  [[nodiscard]] bool may_ask_again(const question& x) const;
  void ask(question& x, router_outputs& out, instant now);
  void begin(const question& x, std::optional<virtual_coordinates> place, router_outputs& out,
             instant now);
  [[nodiscard]] surroundings around(instant now) const;
  [[nodiscard]] std::optional<virtual_coordinates> known_place(mote_id x, instant now) const;
  void learn_place(mote_id x, virtual_coordinates place, instant now);
  void learn_from(std::uint8_t am_type, byte_view payload, instant now);
  void emit(frame_out x, router_outputs& out) const;
  [[nodiscard]] frame_out frame_for(purpose why, mote_id to, std::uint8_t am_type, bytes payload);

  own_router_config config_;
  random_stream rng_;
  neighbours links_;
  gradient tree_;
  coordinates place_;
  instant started_;
  trickle timer_;
  clock_sync clock_;
  collection packets_;
  channels paths_;
  turns turns_;
  instant turn_; ///< frames without a slot wait until then

  std::uint16_t beacon_sequence_ = 0;
  bool beacon_in_flight_ = false;
  bool beacon_due_ = false;          ///< and waits for its turn
  std::optional<instant> relay_due_; ///< of a beacon that passes a clock round on
  unsigned copies_ = 0;              ///< of that round, received so far,
  unsigned relays_ = 0;              ///< and sent
  std::uint64_t frames_ = 0;
  small_map<std::uint64_t, direct> directs_; ///< by token
  std::vector<frame_out> waiting_directs_;   ///< of them, for their turn
  small_map<std::uint64_t, mote_id> handed_; ///< unicasts: to whom
  std::vector<question> questions_;
  place_cache places_;
  std::optional<virtual_coordinates> told_place_;
  mote_id told_parent_ = no_mote;
  instant reported_;                ///< when it told the sink last
  instant seek_end_;                ///< it has looked for a route long enough
  duration report_gap_{};           ///< from then to the next report of a change
  std::optional<instant> hastened_; ///< when it last asked for a sequence number, or told one
  instant helped_;                  ///< when it last sent a beacon soon for those without a route
  time_search search_;
  std::uint64_t steps_ = 0;           ///< of the clock, as far as the search knows
  std::optional<instant> answer_due_; ///< to one who asks for the time,
  unsigned answers_left_ = 0;         ///< of ours, this one among them;
  unsigned answers_ = 0;              ///< of others since then
  instant answered_;                  ///< when we last did
  unsigned silent_windows_ = 0;       ///< in which unicasts have failed since we received anything,
  instant silent_;                    ///< the last one
  std::optional<instant> news_;       ///< when the last round of the clock came,
  duration news_gap_{};               ///< and how long after the one before
  std::optional<instant> request_due_; ///< for more of them
  instant requested_;
  router_counters counters_;
};

} // namespace rubicon::network
