// Creates, finds, joins and leaves groups, and keeps members and session keys of each the same
// everywhere (D1.1 3.4.3, SMP-04 to SMP-14).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "smepp/actions.hpp"
#include "smepp/crypto/handshake.hpp"
#include "smepp/crypto/security.hpp"
#include "smepp/groups/discovery.hpp"
#include "smepp/groups/group.hpp"

namespace rubicon::smepp {

struct group_config {
  mote_id self;
  transducer_mask transducers = 0;
  std::size_t groups_max = 4;      ///< of which we are a member; more are refused
  std::size_t members_max = 32;    ///< of a group; more are refused (group_full)
  std::size_t joins_max = 4;       ///< handshakes at a time, on either side; more are dropped
  bool admits = true;              ///< others, who have the credential
  duration key_grace = 60s;        ///< for session keys that have been replaced
  duration key_period = 24h;       ///< of session keys
  duration rank_pause = 5s;        ///< the next member in line makes new keys so much later
  duration activation = 2s;        ///< besides periods: until all members have new keys,
  unsigned fetching_factor = 4;    ///< longer where each has to fetch them
  unsigned activation_periods = 5; ///< of the management cycle
  unsigned flood_copies = 3;       ///< each member sends news on so often
  duration step_timeout = 500ms;   ///< of a handshake, besides two management periods
  unsigned step_tries = 3;
  duration rumour_pause_max = 5min; ///< between rumours that are followed, in the long run
  duration rumour_wait = 1s;        ///< besides two periods: what was sent to all has come by then
  duration fetch_pause = 2s;        ///< between handshakes of a member
  duration members_pause = 10s;     ///< until the same neighbour is sent all members again
  discovery_config discovery;
  weak_sync_config sync;
};

struct group_counters {
  std::uint64_t admitted = 0;
  std::uint64_t caught_up = 0;
  std::uint64_t keys_made = 0;
  std::uint64_t keys_learned = 0;
  std::uint64_t agreements = 0;                 ///< X25519 computed, each in agreement_time
  std::map<std::string, std::uint64_t> dropped; ///< messages, by cause
};
RUBICON_FIELDS(group_counters, admitted, caught_up, keys_made, keys_learned, agreements, dropped);

/// What each call gets besides its own arguments.
struct context {
  instant now;
  security& keys;
  actions& out;
};

/// News of members and keys spread by gossip: who learns something sends it on, who knows it does
/// not. What is lost all the same is noticed by digests in the periodic stamps, and then asked for:
/// members by their list, keys by a handshake (catch-up), which needs the credential once more.
///
/// Keys change when somebody joins (made by who admits) and after key_period: they are sent to all
/// under the keys before. When somebody has left, who knows those, the lowest member that is there
/// makes new ones (or the next one, if it does not), and each member fetches them from a neighbour
/// that has them, by a handshake that no other can follow.
class group_management {
public:
  group_management() = default;
  /// @param identity by which others know us again
  group_management(group_config config, random_stream rng, randomness secrets,
                   const agreement& identity);

  // ---- what the application wants

  [[nodiscard]] std::variant<group_id, failure> create(const group_description& x, context c);
  void ask(const group_filter& x, context c);
  void join(group_id group, const std::optional<key>& master, context c);
  [[nodiscard]] std::optional<failure> leave(group_id group, context c);
  [[nodiscard]] std::optional<failure> refresh_keys(group_id group, context c);
  void restore(const stored_group& x, context c);

  // ---- what has come

  /// @param frame what it came in. @pre a message of groups or members
  void on_message(mote_id from, const message& x, const opened_frame& frame, context c);
  /// @param at as in weak_sync
  void on_stamp(mote_id from, const sync_stamp& x, group_id group, instant at, context c);
  /// A member of the group has sent a frame under keys that we know,
  void on_member_frame(mote_id from, group_id group, bool is_proven, context c);
  /// or under others.
  void on_foreign_keys(mote_id from, group_id group, context c);
  /// What was sent with a step_token has ended. @returns whether an answer is due
  bool on_step_sent(group_id group, bool acked, context c);

  void on_time(context c);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// @returns whether our join of that group is complete now: joinGroup_result is due
  /// @param subscriptions so many are known
  [[nodiscard]] bool complete_join(group_id id, std::size_t subscriptions, instant now);

  // ---- what is known

  [[nodiscard]] const group* find(group_id x) const;
  [[nodiscard]] group* find(group_id x);
  [[nodiscard]] const std::map<group_id, group>& all() const { return groups_; }
  [[nodiscard]] const discovery& found() const { return discovery_; }
  [[nodiscard]] std::optional<group_description> description(group_id x) const;
  /// Whether the radio must be on whatever the cycles say: we ask, join, or do not know the time.
  [[nodiscard]] bool is_listening(instant now) const;
  /// The management cycle of a group, ours or found, and the group's time; nothing: no cycle.
  struct schedule {
    group_time now;
    management_cycle cycle;
  };
  [[nodiscard]] std::optional<schedule> schedule_of(group_id x, instant now) const;

  [[nodiscard]] const group_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t footprint() const;

private:
  /// We want in.
  struct attempt {
    std::vector<found_member>
        members;      ///< the first is being asked, the others if it does not answer
    join_proof proof; ///< as far as it is known
    agreement own;
    bool is_member = false; ///< catch-up
    bool is_rumour = false; ///< without proof that there is a reason for it
    bool is_proving = false;
    unsigned tries = 0;
    unsigned challenges = 0;
    std::optional<failure> advised; ///< why it failed, as somebody says who need not be right
    instant due;
  };
  /// Another mote was admitted: it may not have received the join_accept.
  static constexpr std::size_t admitted_max = 2;
  struct admitted {
    mote_id joiner;
    group_id group;
    std::uint32_t nonce = 0;
    key under; ///< of the wrapped keys
    key_share share{};
    instant sent;
  };

  void on(mote_id from, const discover& x, const opened_frame& frame, context c);
  void on(mote_id from, const answer& x, const opened_frame& frame, context c);
  void on(mote_id from, const smepp::join& x, const opened_frame& frame, context c);
  void on(mote_id from, const join_challenge& x, const opened_frame& frame, context c);
  void on(mote_id from, const join_proof& x, const opened_frame& frame, context c);
  void on(mote_id from, const join_accept& x, const opened_frame& frame, context c);
  void on(mote_id from, const join_refuse& x, const opened_frame& frame, context c);
  void on(mote_id from, const member_joined& x, const opened_frame& frame, context c);
  void on(mote_id from, const member_left& x, const opened_frame& frame, context c);
  void on(mote_id from, const member_list& x, const opened_frame& frame, context c);
  void on(mote_id from, const key_refresh& x, const opened_frame& frame, context c);

  [[nodiscard]] duration activation_time(const group& g, bool by_handshakes) const;
  [[nodiscard]] duration step_timeout(const management_cycle& x) const;
  [[nodiscard]] handshake handshake_of(const attempt& x) const;
  [[nodiscard]] attempt* attempt_with(mote_id from, group_id group, std::uint32_t nonce);
  void start(attempt x, context c);
  void send_step(attempt& x, context c);
  void prove(attempt& x, context c);
  void go_on(attempt& x, failure why, context c);
  void finish(group_id group, std::optional<failure> error, context c);
  void enter(const attempt& x, const session_keys& session, const join_accept& accept,
             std::uint64_t counter, context c);
  void caught_up(group& g, mote_id from, const session_keys& session, const join_accept& accept,
                 context c);
  [[nodiscard]] std::uint64_t turn(const group& g, instant now) const;
  void ask_for_proof(mote_id from, const smepp::join& x, const group& g, context c);
  [[nodiscard]] bool has_cookie(mote_id from, const join_proof& x, const group& g,
                                instant now) const;
  void admit(group& g, const handshake& with, std::uint64_t counter, context c);
  void note_joiner(group& g, const handshake& with, context c);
  void welcome(group& g, admitted& x, context c);
  void refuse(mote_id joiner, const join_proof& x, failure why, tag mac, context c);
  void catch_up(mote_id from, group& g, bool is_rumour, context c);
  [[nodiscard]] bool is_refuser(const group& g, mote_id who, instant now) const;
  void note_refuser(group& g, mote_id who, instant now);
  void check_rumours(group& g, context c);
  [[nodiscard]] duration rumour_wait(const group& g) const; ///< whole periods
  [[nodiscard]] std::optional<key> agree(const agreement& own, const key_share& other);
  [[nodiscard]] member own_entry(std::uint16_t stamp) const;

  void make_keys(group& g, bool somebody_left, context c);
  void on_left(group& g, context c);
  [[nodiscard]] std::optional<instant> next_keys(const group& g) const;
  void announce(const group& g, session_id under, unsigned copies, context c);
  void changed(group& g, context c);
  void learn(group& g, const member& x, bool spread, context c);
  void send_members(mote_id to, group& g, context c);
  [[nodiscard]] group& add(group_id id, const group_description& x, context c);
  [[nodiscard]] key credential(const group& g, const security& keys) const {
    return credential_of(g.description, keys.network_keys());
  }
  void drop(const char* why) { ++counters_.dropped[why]; }

  group_config config_;
  random_stream rng_;
  randomness secrets_;
  agreement identity_;
  key_share identity_share_{};
  key cookie_key_; ///< of this life
  std::map<group_id, group> groups_;
  discovery discovery_;
  std::map<group_id, attempt> attempts_;
  std::vector<admitted> admitted_; ///< lately, the longest ago first
  struct answered {
    mote_id asker;
    std::uint64_t nonce = 0;
    instant at;
  };
  [[nodiscard]] bool has_answered(mote_id asker, std::uint64_t nonce, instant now);
  std::vector<answered> answered_;
  rate_limiter agreements_{4, 500ms}; ///< of those who have the credential, or say so to us
  group_counters counters_;
};

} // namespace rubicon::smepp
