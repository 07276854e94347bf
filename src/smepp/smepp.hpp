// SMEPP Light of one mote: the interface of D1.1 table 1, and what a mote's shell does for it.
//
//   application --smepp_*--> peer --send_frame, set_radio, store_state--> the mote
//   application <--signals-- peer <--on_frame, on_sent, on_time--------- the mote
//
// Group ids and names are those of D1.1 (SMP-01 to SMP-21). Nothing of full SMEPP's services is
// here (SMP-31).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "smepp/actions.hpp"
#include "smepp/crypto/security.hpp"
#include "smepp/events/energy.hpp"
#include "smepp/events/event_management.hpp"
#include "smepp/events/outbox.hpp"
#include "smepp/groups/group_management.hpp"

namespace rubicon::smepp {

/// Holds keys: neither logged nor sent.
struct peer_config {
  mote_id self;                    ///< the mote's TinyOS id (SMP-01)
  transducer_mask transducers = 0; ///< what the mote is equipped with (SMP-11)
  bool saves_energy = true;        ///< else the radio stays on; nothing else differs (SMP-27)
  energy_config energy = {};
  duration event_window = 100ms; ///< length of a subscription's windows
  duration frame_time = 8ms;     ///< a longest frame with its acknowledgement; none begins later
  duration send_spread = 20ms;   ///< between motes that have news at one time
  duration sent_timeout = 2s;    ///< the radio has forgotten a frame
  /// Each so many management periods one is listened to as a whole: parts of a group that have
  /// lost each other's time find each other. 0: never.
  std::uint32_t scout_every = 64;
  /// Keys are drawn from the operating system; else from the peer's own stream.
  bool has_system_randomness = false;
  std::size_t outbox_max = 40;   ///< messages; the newest is dropped, counted
  security_config security = {}; ///< self is set by the peer, here and below
  group_config groups = {};
  event_config events = {};
  /// Master keys by a group's name: joinGroup takes no other there.
  std::map<std::string, key> masters = {};
  /// Shared with one other each; those beyond the room of pairwise_keys are not used.
  std::vector<std::pair<mote_id, key>> pairwise = {};
};

/// All that outlasts a loss of power. Holds keys: neither logged nor sent.
struct persistent_state {
  std::uint64_t counter_reserved = 0; ///< counters below may have been used
  std::uint64_t counter_end =
      std::numeric_limits<std::uint64_t>::max(); ///< others are of later lives
  std::optional<agreement::secret> identity;     ///< by which other members know it again
  std::vector<stored_group> groups;
};

/// The store is to hold this from now on. Comes before all that needs it.
struct store_state {
  persistent_state content;
};

/// Hand this frame to the radio, and call on_sent() with the outcome.
struct send_frame {
  std::uint64_t id = 0;
  mote_id to; ///< a neighbour, which acknowledges, or broadcast_mote
  bytes octets;
  std::string_view what; ///< the message's name, for records; of static storage
  provenance from = {};
};

struct set_radio {
  bool on = false;
};

using output = std::variant<store_state, send_frame, set_radio, signal>;
using outputs = std::vector<output>;

struct peer_counters {
  std::uint64_t frames_sent = 0;
  std::uint64_t octets_sent = 0;                ///< of them, headers of the radio not counted
  std::map<std::string, std::uint64_t> sent;    ///< frames, by message
  std::map<std::string, std::uint64_t> dropped; ///< frames that came and messages not sent
};
RUBICON_FIELDS(peer_counters, frames_sent, octets_sent, sent, dropped);

/// Peer Identification, Group Management and Event Management over Security, Network and Energy
/// Efficiency (D1.1 figure 9, SMP-28). One frame is at the radio at a time.
///
/// Commands return their result at once; what else follows is appended to `out`. A command that
/// fails changes nothing and says why. @pre smepp_newPeer comes first
class peer {
public:
  /// @param before what store_state gave last, in a former life
  peer(peer_config config, random_stream rng, instant now, persistent_state before = {});
  ~peer(); // these are large: compiled once
  peer(peer&&) noexcept;
  peer& operator=(peer&&) noexcept;

  // ---- D1.1 table 1
  // NOLINTBEGIN(readability-identifier-naming): its names

  /// Sets the network keys; groups of a former life are taken up again.
  mote_id smepp_newPeer(const key& network_key, const key& network_mac, instant now, outputs& out);
  /// No frame is sent (SMP-04).
  std::variant<group_id, failure> smepp_createGroup(const group_description& x, instant now,
                                                    outputs& out);
  void smepp_getGroups(const group_filter& x, instant now, outputs& out);
  [[nodiscard]] std::optional<group_description> smepp_getGroupDescription(group_id group) const;
  /// @param master_key nothing: an open group, or the key that it was looked for with. Where one is
  /// provisioned, `master_key` has to be it
  void smepp_joinGroup(group_id group, const std::optional<key>& master_key, instant now,
                       outputs& out);
  [[nodiscard]] std::vector<peer_description> smepp_getPeers(group_id group) const;
  std::optional<failure> smepp_leaveGroup(group_id group, instant now, outputs& out);
  /// @param expiration_time nothing: never
  /// @param rate in 1/s, at least once in 46 days; 0: none
  std::optional<failure> smepp_subscribe(const std::string& event_name, group_id group,
                                         std::optional<duration> expiration_time, double rate,
                                         instant now, outputs& out);
  /// @param event_name empty: all of ours in the group
  std::optional<failure> smepp_unsubscribe(const std::string& event_name, group_id group,
                                           instant now, outputs& out);
  std::optional<failure> smepp_event(group_id group, const std::string& event_name,
                                     const bytes& value, instant now, outputs& out);
  /// @param frequency in 1/s, at which our radio wakes for it; 0: the rate
  std::optional<failure> smepp_receive(group_id group, const std::string& event_name,
                                       double frequency, instant now, outputs& out);

  // NOLINTEND(readability-identifier-naming)

  // ---- beyond table 1

  void set_network_keys(const key& network_key, const key& network_mac, instant now, outputs& out);
  std::optional<failure> refresh_session_keys(group_id group, instant now, outputs& out);

  // ---- the mote

  /// @param to as the radio had it: self or broadcast_mote
  /// @param at when its start-of-frame delimiter was received
  /// @param now at or after that
  void on_frame(mote_id from, mote_id to, byte_view octets, instant at, instant now, outputs& out);

  /// @param acked of a unicast; of a broadcast: it was sent
  /// @param at when its start-of-frame delimiter was on the air
  /// @param now at or after that
  void on_sent(std::uint64_t id, bool acked, instant at, instant now, outputs& out);

  void on_time(instant now, outputs& out); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  // ---- for those who look

  [[nodiscard]] bool is_radio_on() const { return is_radio_on_; }
  [[nodiscard]] const group_management& groups() const { return groups_; }
  [[nodiscard]] const event_management& events() const { return events_; }
  [[nodiscard]] const security& keys() const { return security_; }
  [[nodiscard]] const peer_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t waiting() const { return outbox_.size(); }
  /// Octets of state on a mote with tables of these sizes (SMP-30).
  [[nodiscard]] std::size_t footprint() const;

private:
  struct flight {
    std::uint64_t id = 0;
    std::uint64_t token = 0;
    group_id stamp; ///< of a stamp: its group
    instant until;
  };

  [[nodiscard]] context with(instant now) { return {now, security_, actions_}; }
  void on_network_frame(mote_id from, const message& x, const opened_frame& frame, instant now);
  void on_group_frame(mote_id from, const message& x, const opened_frame& frame, instant at,
                      instant now);
  void on_unproven(mote_id from, const message& x, const opened_frame& frame, instant now);
  void answer_challenge(mote_id from, const challenge& x, const opened_frame& frame, instant now);
  void check_step(const message& x, group_id group, instant now);
  void on_stamp(mote_id from, const sync_stamp& x, group_id group, instant at, instant now);
  void perform(instant now, outputs& out);
  void perform(const to_send& x, instant now, outputs& out);
  void perform(const keys_changed& x, instant now, outputs& out);
  void perform(const group_gone& x, instant now, outputs& out);
  void perform(const newcomer& x, instant now, outputs& out);
  void perform(const signal& x, instant now, outputs& out);
  void complete_joins(instant now);
  void go_on(instant now, outputs& out);
  void pump(instant now, outputs& out);
  bool hand_out(const to_send& x, instant now, outputs& out);
  void complete(message& content, const to_send& x, instant now);
  void end_hop(std::uint64_t token, bool acked, instant now);
  [[nodiscard]] outbox::pause wait(const to_send& x, instant now) const;
  void set_cycles(instant now);
  void set_radio_state(instant now, outputs& out);
  [[nodiscard]] persistent_state to_store() const;
  void drop(std::string_view why) { ++counters_.dropped[std::string(why)]; }

  peer_config config_;
  random_stream rng_;
  randomness secrets_;
  persistent_state persistent_;
  security security_;
  group_management groups_;
  event_management events_;
  energy energy_;
  outbox outbox_;
  actions actions_; ///< being performed
  std::optional<flight> flight_;
  std::uint64_t frame_ = 0;
  instant awake_until_;
  instant cycles_from_; ///< when energy_ was last updated
  instant last_;        ///< input
  bool is_radio_on_ = false;
  peer_counters counters_;
};

} // namespace rubicon::smepp
