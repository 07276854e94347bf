// Creates, finds, joins and leaves groups, and keeps members and session keys of each the same
// everywhere (D1.1 3.4.3, SMP-04 to SMP-14, A-71).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/fields.hpp"
#include "core/random.hpp"
#include "smepp/actions.hpp"
#include "smepp/discovery.hpp"
#include "smepp/group.hpp"
#include "smepp/handshake.hpp"
#include "smepp/security.hpp"

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
  duration rumour_pause_max = 5min;
  duration rumour_wait = 1s; ///< besides two periods: what was sent to all has come by then
  duration fetch_pause = 2s; ///< between handshakes of a member
  duration told_pause = 10s; ///< until the same neighbour is sent all members again
  discovery_config discovery;
  weak_sync_config sync;
};

struct group_counters {
  std::uint64_t admitted = 0;
  std::uint64_t caught_up = 0;
  std::uint64_t keys_made = 0;
  std::uint64_t keys_learned = 0;
  std::map<std::string, std::uint64_t> dropped; ///< messages, by cause
};
RUBICON_FIELDS(group_counters, admitted, caught_up, keys_made, keys_learned, dropped);

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
/// that has them, by a handshake that nobody else can follow.
class group_management {
public:
  group_management() = default;
  group_management(group_config config, random_stream rng);

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
  /// Somebody in the group was heard under keys that we know, proven or not,
  void on_heard(mote_id from, group_id group, context c);
  /// or under others.
  void on_foreign_keys(mote_id from, group_id group, context c);

  void on_time(context c);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// @returns the groups whose new member knows enough now: joinGroup_result is due
  /// @param subscriptions so many are known
  [[nodiscard]] bool settle(group_id id, std::size_t subscriptions, instant now);

  // ---- what is known

  [[nodiscard]] const group* find(group_id x) const;
  [[nodiscard]] group* find(group_id x);
  [[nodiscard]] std::map<group_id, group>& all() { return groups_; }
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
    group_description description;
    handshake with;
    agreement own;
    std::vector<mote_id> next; ///< members to try if this one does not answer
    bool is_member = false;    ///< catch-up
    bool is_proving = false;
    unsigned tries = 0;
    instant due;
  };
  /// Somebody else does.
  struct applicant {
    handshake with;
    agreement own;
    transducer_mask transducers = 0;
    bool is_member = false;
    instant until;
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
  void start(attempt x, context c);
  void send_step(const attempt& x, context c);
  void go_on(attempt& x, failure why, context c);
  void finish(group_id group, std::optional<failure> error, context c);
  void enter(const attempt& x, const session_keys& session, const join_accept& accept,
             std::uint32_t counter, context c);
  void caught_up(group& g, const session_keys& session, const join_accept& accept, context c);
  void admit(group& g, const applicant& x, std::uint32_t counter, context c);
  void refuse(const applicant& x, failure why, context c);
  void catch_up(mote_id from, group& g, context c);
  void check_rumour(group& g, context c);

  void make_keys(group& g, bool somebody_left, context c);
  [[nodiscard]] std::optional<instant> next_keys(const group& g) const;
  void announce(const group& g, session_id under, unsigned copies, context c);
  void changed(group& g, context c);
  void learn(group& g, const member& x, bool spread, context c);
  void tell(mote_id to, group& g, context c);
  [[nodiscard]] group& add(group_id id, const group_description& x, context c);
  [[nodiscard]] key credential(const group& g, const security& keys) const {
    return credential_of(g.description, keys.network_keys());
  }
  void drop(const char* why) { ++counters_.dropped[why]; }

  group_config config_;
  random_stream rng_;
  std::map<group_id, group> groups_;
  discovery discovery_;
  std::map<group_id, attempt> attempts_;
  std::vector<applicant> applicants_;
  struct answered {
    mote_id asker;
    std::uint32_t nonce = 0;
    instant at;
  };
  [[nodiscard]] bool has_answered(mote_id asker, std::uint32_t nonce, instant now);
  std::vector<answered> answered_;
  allowance answers_{8, 250ms};
  allowance challenges_{4, 500ms};
  group_counters counters_;
};

} // namespace rubicon::smepp
