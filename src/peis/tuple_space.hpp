// The tuple space of one peer: its own tuples, copies of others', and who wants what
// (peis-wire.md 15, requirements A11, A12).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/fields.hpp"
#include "core/time.hpp"
#include "peis/neighbour_budget.hpp"
#include "peis/push_window.hpp"
#include "peis/subscriber_table.hpp"
#include "peis/subscription_index.hpp"
#include "peis/tuple.hpp"
#include "peis/tuple_channels.hpp"
#include "peis/tuple_events.hpp"
#include "peis/tuple_record.hpp"
#include "peis/tuple_store.hpp"
#include "peis/types.hpp"

namespace rubicon::peis {

struct tuple_space_config {
  std::size_t tuples_max = 1'000'000;      ///< own and held ones
  std::size_t subscriptions_max = 100'000; ///< of our own, callbacks included
  // What others can put here. Each limit is shared: one host alone gets four fifths (fair_share).
  // Octets are with all that surrounds a record or tuple in memory; those of all kinds together
  // have a limit that is less than the sum of their own.
  std::size_t others_octets_max = std::size_t{112} << 20U;
  std::size_t subscribers_max = 125'000; ///< records of others
  std::size_t subscribers_octets_max = std::size_t{112} << 20U;
  std::size_t subscribers_per_key_max = 64; ///< prototypes of one host with one key or pattern
  std::size_t held_octets_max = std::size_t{96} << 20U;    ///< tuples of other owners
  std::size_t written_octets_max = std::size_t{24} << 20U; ///< own tuples that others have written
  /// Of these, what writers that are gone may leave behind for longer than `orphan_age`: beyond it
  /// the largest that they have created go.
  std::size_t orphaned_octets_max = std::size_t{2} << 20U;
  duration orphan_age = 30s;
  std::size_t stale_octets_max = std::size_t{16} << 20U; ///< see keep_values_of_dead_hosts
  std::size_t strangers_max = 256; ///< hosts that use this space before the network knows them
  duration stranger_age = 45s;     ///< after this long without a word they are forgotten
  /// What others may make a value grow to by appending: each append copies it.
  std::size_t append_octets_max = std::size_t{1} << 20U;
  std::size_t append_matches_max = 256; ///< tuples that one request of another may change
  push_window_config pushes = {};
  std::size_t missed_max =
      1024;                 ///< values that one host missed, one by one; then all are looked at
  duration lifetime = 60s;  ///< of our subscriptions at marked hosts; 1..255 s
  duration retry_push = 1s; ///< a push that failed is tried again (TUP-18)
  duration give_up_push = 30s;
  std::size_t appends_waiting_max = 64; ///< notices per subscriber and tuple; then a whole push
  std::size_t appends_waiting_octets_max = std::size_t{16} << 20U; ///< of all notices that wait
  duration repair_append = 2s; ///< a whole value that was asked for is asked for again
  unsigned repairs_max = 5;
  bool keep_values_of_dead_hosts = false; ///< marked as stale, instead of removed (TUP-19)
};

struct tuple_counters {
  std::uint64_t tuples = 0;             ///< held now, own ones included
  std::uint64_t subscriptions = 0;      ///< of ours, now
  std::uint64_t subscribers = 0;        ///< records of others, now
  std::uint64_t subscribers_octets = 0; ///< they take, now
  std::uint64_t held_octets = 0;        ///< tuples of others take, now
  std::uint64_t written_octets = 0;     ///< own tuples written by others take, now
  std::uint64_t pushes_octets = 0;      ///< in flight, now
  std::uint64_t debtors = 0;            ///< hosts that are still to be told something, now
  std::uint64_t steps = 0;       ///< of deferred work: tuples and subscriptions that were looked at
  std::uint64_t sets = 0;        ///< of own tuples
  std::uint64_t remote_sets = 0; ///< of own tuples, by others
  std::uint64_t pushes_sent = 0;
  std::uint64_t pushes_received = 0;
  std::uint64_t pushes_retried = 0;
  std::uint64_t pushes_given_up = 0;
  std::uint64_t pushes_deferred = 0; ///< had to wait for room: only the newest value leaves then
  /// Values that some subscriber never gets: a newer one took their place while they waited.
  std::uint64_t pushes_overtaken = 0;
  std::uint64_t resyncs = 0; ///< a host missed too many: all it wants is sent again
  std::uint64_t expired = 0;
  std::uint64_t appends = 0; ///< to own tuples, by us and others
  std::uint64_t append_notices_sent = 0;
  std::uint64_t append_notices_received = 0;
  std::uint64_t appends_collapsed = 0; ///< notices given up for a push of the whole value
  std::uint64_t append_gaps = 0;       ///< a notice did not fit what we hold: asked for all of it
  // Dropped.
  std::uint64_t malformed = 0;        ///< a message that is no legal tuple, or not the sender's
  std::uint64_t unwanted = 0;         ///< pushed, but nobody here has subscribed
  std::uint64_t outdated = 0;         ///< pushed, but we hold a newer value (TUP-17)
  std::uint64_t refused = 0;          ///< remote writes of reserved keys (TUP-22), commands refused
  std::uint64_t absent_forgotten = 0; ///< hosts that were away, with what they had subscribed to
  std::uint64_t overflow = 0; ///< no room for a tuple of another or of its writing, value too long
  std::uint64_t subscribers_refused = 0; ///< subscriptions of others without room
  std::uint64_t strangers_refused = 0; ///< messages of hosts that nobody knows, beyond their table
  std::uint64_t orphans_removed = 0;   ///< own tuples whose writers are gone
  std::uint64_t stale_removed = 0;     ///< values of dead hosts, beyond what may be kept
  std::uint64_t appends_refused = 0;   ///< of others: too many tuples, or a value too long
  std::uint64_t append_gaps_given_up = 0; ///< the owner did not send the whole value
  std::uint64_t bad_meta_tuples = 0;      ///< followed, but their text says nothing (META-01)
};
RUBICON_FIELDS(tuple_counters, tuples, subscriptions, subscribers, subscribers_octets, held_octets,
               written_octets, pushes_octets, debtors, steps, sets, remote_sets, pushes_sent,
               pushes_received, pushes_retried, pushes_given_up, pushes_deferred, pushes_overtaken,
               resyncs, expired, appends, append_notices_sent, append_notices_received,
               appends_collapsed, append_gaps, malformed, unwanted, outdated, refused,
               absent_forgotten, overflow, subscribers_refused, strangers_refused, orphans_removed,
               stale_removed, appends_refused, append_gaps_given_up, bad_meta_tuples);

/// Knows which hosts are there (on_host_appeared, on_host_vanished), but neither links nor routes.
class tuple_space {
public:
  tuple_space() = default;
  tuple_space(tuple_space_config config, peer_id self, duration clock_offset);

  // Commands. A cause other than none means that nothing has been done.
  [[nodiscard]] std::pair<cause, tuple_events> set(const key& name, tuple_content content,
                                                   instant now);
  /// Of the tuple the owner, who must be we, key, value, MIME type, encoding, user time and expiry
  /// count.
  [[nodiscard]] std::pair<cause, tuple_events> insert(tuple x, instant now);
  [[nodiscard]] tuple_events remove(const key& name, instant now);
  /// To our own tuples that match. Text gets its trailing NUL.
  [[nodiscard]] std::pair<cause, tuple_events> append(const prototype& wanted, const payload& added,
                                                      instant now);
  /// The message that asks an owner to set (insert() says what counts) or delete a tuple.
  [[nodiscard]] std::pair<cause, transmit> ask_to_set(tuple x, request_id request,
                                                      instant now) const;
  [[nodiscard]] std::pair<cause, transmit> ask_to_delete(peer_id owner, const key& name,
                                                         request_id request, instant now) const;
  /// A tuple of that owner from what a user gives; unset if a time cannot be carried.
  [[nodiscard]] std::optional<tuple> draft(peer_id owner, const key& name,
                                           tuple_content content) const;

  /// A callback is told of what arrives, but asks nobody for it.
  enum class interest : std::uint8_t { subscription, callback };
  [[nodiscard]] std::pair<cause, tuple_events>
  subscribe(const prototype& wanted, subscription_id id, interest kind, instant now);
  [[nodiscard]] std::pair<cause, tuple_events> unsubscribe(subscription_id id);
  [[nodiscard]] bool has_subscription(subscription_id id) const {
    return subscriptions_.contains(id);
  }

  // Messages of other peers.
  [[nodiscard]] tuple_events on_push(peer_id source, const payload& octets, instant now);
  /// Refused unless `may_write` says otherwise for this key of ours.
  [[nodiscard]] tuple_events on_set(peer_id source, const tuple& x, bool may_write, instant now);
  [[nodiscard]] tuple_events on_subscribe(peer_id source, byte_view octets, instant now);
  [[nodiscard]] tuple_events on_unsubscribe(peer_id source, byte_view octets);
  [[nodiscard]] tuple_events on_append_request(peer_id source, const payload& octets, instant now);
  [[nodiscard]] tuple_events on_append_notice(peer_id source, const payload& octets, instant now);
  /// A set message for one of our tuples; counts what is malformed.
  [[nodiscard]] std::optional<tuple> decode_set(const payload& octets, instant now);

  // What happens to hosts and to our own messages.
  /// @param marked it is of our kind: subscriptions to it carry a lifetime and are refreshed
  /// @param incarnation what of an unmarked host that vanished comes back with the same number; 0:
  ///        nothing does
  [[nodiscard]] tuple_events on_host_appeared(peer_id host, bool marked, instant now,
                                              std::int32_t incarnation = 0);
  [[nodiscard]] tuple_events on_host_vanished(peer_id host, instant now);
  /// Sends all subscriptions to a host again.
  /// @param refresh it need not send what they match again if it knows them
  [[nodiscard]] tuple_events renew(peer_id host, instant now, bool refresh = true);
  /// A message with a request of ours has been acknowledged.
  [[nodiscard]] tuple_events on_delivered(request_id request, instant now);
  /// A push, append notice or subscription could not be delivered.
  void on_undelivered(peer_id destination, std::uint16_t port, byte_view head, request_id request,
                      instant now);

  [[nodiscard]] tuple_events on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// What others have put here counts against it; others who keep what they send may use it too.
  [[nodiscard]] const std::shared_ptr<fair_share>& memory() const { return others_; }

  /// Network time minus ecology time from now on. What is held expires when it was to (SCH-07).
  void set_clock_offset(duration offset) { clock_offset_ = offset; }

  // Looking. What has expired is still found until on_time(), unless `now` is given.
  [[nodiscard]] tuple_pointer find(peer_id owner, const key& name) const; ///< null if none
  [[nodiscard]] std::vector<tuple_pointer> find_all(const prototype& wanted) const {
    return store_.find_all(wanted);
  }
  /// Calls `visit(const tuple_pointer&, bool is_new)` for each match that has not expired,
  /// ascending by key, then owner, and marks those as read for which it returns true (TUP-12).
  template <class Visitor>
  void read(const prototype& wanted, instant now, Visitor visit) const {
    store_.for_matching(wanted, [&](const tuple_store::entry& x) {
      if (x.expiry > now && visit(x.content, x.is_new))
        x.is_new = false;
    });
  }
  /// Calls `visit(const tuple&)` for our own, ascending by key, as long as it returns true.
  template <class Visitor>
  void for_own(Visitor visit) const {
    std::string after;
    static_cast<void>(
        store_.walk_on(self_, key(), after, [&](const auto& x) { return visit(*x.content); }));
  }
  [[nodiscard]] bool has_subscriber(const key& name) const;
  /// Does the present value of an own tuple still wait for room on its way to somebody? Another one
  /// would overtake it.
  [[nodiscard]] bool is_waiting(const key& name) const;
  [[nodiscard]] bool is_watched(const key& name) const; ///< or a callback here
  /// Who has subscribed to what here, ascending by host, owner, key.
  [[nodiscard]] std::vector<std::pair<peer_id, prototype>> subscribers() const;
  /// Folded keys and patterns of subscriptions to our own tuples, others' and ours, whose first
  /// part is this one and no wildcard; ascending, each once. @param first_part in lower case
  [[nodiscard]] std::set<std::string> subscribed(std::string_view first_part) const;
  /// Change whenever subscriptions and callbacks, ours or others' here, and the set of own keys do.
  [[nodiscard]] std::uint64_t subscribers_version() const { return subscribers_version_; }
  [[nodiscard]] std::uint64_t own_keys_version() const { return own_keys_version_; }
  void count_bad_meta_tuple() { ++counters_.bad_meta_tuples; }
  [[nodiscard]] timestamp network_time(instant now) const;
  [[nodiscard]] tuple_counters counters() const;

  /// What the calls since the last time have cost, beyond one unit for each event they returned.
  [[nodiscard]] work_units take_work() { return work_.take(); }

private:
  struct subscription {
    subscription_id id;
    prototype wanted;
    interest kind = interest::subscription;
  };
  /// Equal subscriptions of ours, which others are asked for once.
  struct question {
    prototype wanted;
    std::uint64_t serial = 0;
    std::size_t askers = 0;
  };
  /// What a host is still to be told. It leaves as room and time allow, so that a question about
  /// all tuples costs no more at once than one about a single tuple.
  struct debt {
    struct asking {
      std::uint64_t next = 0; ///< serial of the next question
      bool refresh = false;
    };
    std::optional<asking> ask;
    std::optional<bool> ask_again;         ///< as a refresh or not, when that is through
    std::set<std::uint64_t> asked_in_vain; ///< serials
    /// Folded keys of values and deletions that did not leave, and since when they fail.
    std::map<std::string, std::optional<instant>, std::less<>> missed;
    std::string missed_after;                   ///< the last one looked at
    std::map<std::uint64_t, subscriber*> walks; ///< subscriptions whose matches are to be sent
    std::string after;                          ///< the last tuple that the first of them has had
    std::optional<instant> not_before;
    std::optional<instant> due; ///< where it is in the agenda

    [[nodiscard]] bool settled() const {
      return !ask && asked_in_vain.empty() && missed.empty() && walks.empty();
    }
  };
  using debts = std::map<peer_id, debt>;
  struct known_host {
    bool marked = false;
    std::int32_t incarnation = 0;
  };
  /// What a real kernel that was given up had subscribed to. It does not say it again if it has not
  /// given us up, too.
  struct dormant_host {
    std::int32_t incarnation = 0;
    std::vector<prototype> wanted;
  };
  /// A held value that lacks an append: the owner was asked for all of it.
  struct incomplete {
    key name;
    std::int32_t seqno = 0;
    std::size_t size = 0; ///< of the value that has the append
    unsigned asked = 0;
    instant ask_again;
  };
  using incomplete_key = std::pair<peer_id, std::string>; ///< owner, folded key

  // tuple_space.cpp
  [[nodiscard]] tuple_events store_own(tuple x, tuple_store::source by, instant now);
  tuple_pointer put_own(tuple x, tuple_store::source by);
  void tell_changed(const tuple_pointer& x, tuple_events& out) const;
  void tell_deleted(const tuple_pointer& x, tuple_events& out) const;
  [[nodiscard]] std::vector<subscription_id> interested(const tuple& x) const;
  [[nodiscard]] bool full(const key& name, peer_id owner) const;
  [[nodiscard]] std::optional<instant> expiry_of(const tuple& x) const;
  [[nodiscard]] cause prepare(tuple& x, instant now) const;
  [[nodiscard]] bool replaces(const tuple& x, const tuple& held, bool deletion) const;
  void forget_own(const tuple& gone);

  // tuple_hosts.cpp
  void lay_down(peer_id host);
  void wake_up(peer_id host, std::int32_t incarnation, instant now, tuple_events& out);
  void forget_host(peer_id host, instant now, tuple_events& out);
  [[nodiscard]] bool acquainted(peer_id source, instant now);
  void forget_strangers(instant now, tuple_events& out);
  void remove_orphans(instant now, tuple_events& out);

  // tuple_subscriptions.cpp
  [[nodiscard]] bool has_subscribed(peer_id host, const tuple& x) const;
  [[nodiscard]] transmit subscribe_message_to(peer_id host, const known_host& known,
                                              const prototype& wanted, bool refresh) const;
  [[nodiscard]] bool wanted(const tuple& x) const;
  const question* add_question(const prototype& wanted);
  void remove_question(const prototype& wanted);
  void refresh(instant now, tuple_events& out);

  // tuple_pushes.cpp
  void push(const tuple& x, instant now, tuple_events& out);
  [[nodiscard]] std::vector<peer_id> subscribers_of(const tuple& x) const;
  [[nodiscard]] transmit in_flight(transmit message, std::optional<std::uint64_t> serial,
                                   std::optional<instant> failing_since);
  [[nodiscard]] debt* waiting_for_way(peer_id host, instant now);
  void miss_unreached(peer_id host, debt& x, const tuple& changed);
  void miss(peer_id host, const std::string& folded, std::optional<instant> failing_since);
  void miss_for_now(peer_id host, const key& name, instant failing_since, instant now);
  void resynchronise(peer_id host, debt& x);
  void ask_all(peer_id host, bool refresh);
  void owe_walk(subscriber& x);
  void forget_walk(peer_id host, std::uint64_t number);
  [[nodiscard]] tuple deletion_of(const key& name, instant now) const;
  [[nodiscard]] bool blocked(peer_id host, debt& x, std::size_t octets, instant now) const;
  void serve_now(peer_id host, instant now, tuple_events& out);
  void serve(peer_id host, debt& x, std::size_t& steps, instant now, tuple_events& out);
  bool ask_on(peer_id host, debt& x, std::size_t& steps, instant now, tuple_events& out);
  bool repeat_missed(peer_id host, debt& x, std::size_t& steps, instant now, tuple_events& out);
  bool walk_on(peer_id host, debt& x, std::size_t& steps, instant now, tuple_events& out);
  void push_walked(peer_id host, const key& name, instant now, tuple_events& out);
  void settle(debts::iterator at, instant now);
  void plan(peer_id host, debt& x, std::optional<instant> due);
  void work(instant now, tuple_events& out);

  // tuple_appends.cpp
  [[nodiscard]] cause append_to(const tuple_pointer& held, const payload& added,
                                tuple_store::source by, instant now, tuple_events& out);
  void append_whole(tuple next, tuple_store::source by, tuple_events& out);
  void append_notified(const tuple& before, tuple next, const payload& added,
                       tuple_store::source by, instant now, tuple_events& out);
  [[nodiscard]] std::optional<std::vector<tuple_pointer>>
  matches_for_other(const prototype& wanted);
  [[nodiscard]] bool can_notify(const tuple& held) const;
  void collapse(const key& name, instant now);
  void note_gap(peer_id owner, const key& name, std::int32_t seqno, std::size_t size, instant now,
                tuple_events& out);
  void check_completeness(const tuple& pushed);
  void repair_appends(instant now, tuple_events& out);
  void transmit_in_order(const key& name, transmit message, tuple_events& out);

  tuple_space_config config_;
  peer_id self_;
  duration clock_offset_{};
  std::shared_ptr<fair_share> others_; ///< octets of all that others have put here
  tuple_store store_;
  std::int32_t first_seqno_ = 0; ///< above every number that a deleted own tuple has had
  tuple_channels channels_;

  std::map<subscription_id, subscription> subscriptions_;
  subscription_index<subscription> wanted_;   ///< the same, by key
  std::map<std::string, question> questions_; ///< by identity
  std::map<std::uint64_t, const question*> questions_by_serial_;
  std::uint64_t next_serial_ = 0;
  subscriber_table subscribers_;
  std::uint64_t subscribers_version_ = 0;
  std::uint64_t own_keys_version_ = 0;
  std::map<peer_id, known_host> hosts_;
  std::map<peer_id, dormant_host> dormant_;
  std::map<peer_id, instant> strangers_; ///< not in hosts_, and when they were last heard
  push_window window_;
  debts debts_;
  std::size_t missed_ = 0; ///< in all debts
  /// Whose debts are looked at when. Those that wait for an acknowledgement are not in it.
  std::set<std::pair<instant, peer_id>> agenda_;
  std::map<incomplete_key, incomplete> incomplete_;
  std::optional<instant> next_work_;
  std::optional<instant> next_stranger_;
  std::optional<instant> next_orphan_;
  std::optional<instant> next_refresh_; ///< of our subscriptions, and check of those of others
  std::optional<instant> next_repair_;
  work_meter work_;
  tuple_counters counters_;
};

/// The longest value that fits into a message with the longest MIME type.
inline constexpr std::size_t tuple_value_max =
    std::size_t{16384} * 1024 - tuple_record_size - mimetype_length_max;

} // namespace rubicon::peis
