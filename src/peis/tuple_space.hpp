// The tuple space of one peer: its own tuples, copies of others', and who wants what
// (peis-wire.md 15, requirements A11, A12).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/time.hpp"
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
  std::size_t subscribers_max = 100'000;   ///< records of others
  duration lifetime = 60s;                 ///< of our subscriptions at marked hosts; 1..255 s
  duration retry_push = 1s;                ///< a push that failed is tried again (TUP-18)
  duration give_up_push = 30s;
  std::size_t appends_waiting_max = 64; ///< notices per subscriber and tuple; then a whole push
  duration repair_append = 2s;          ///< a whole value that was asked for is asked for again
  unsigned repairs_max = 5;
  bool keep_values_of_dead_hosts = false; ///< marked as stale, instead of removed (TUP-19)
};

struct tuple_counters {
  std::uint64_t tuples = 0;        ///< held now, own ones included
  std::uint64_t subscriptions = 0; ///< of ours, now
  std::uint64_t subscribers = 0;   ///< records of others, now
  std::uint64_t sets = 0;          ///< of own tuples
  std::uint64_t remote_sets = 0;   ///< of own tuples, by others
  std::uint64_t pushes_sent = 0;
  std::uint64_t pushes_received = 0;
  std::uint64_t pushes_retried = 0;
  std::uint64_t pushes_given_up = 0;
  std::uint64_t expired = 0;
  std::uint64_t appends = 0; ///< to own tuples, by us and others
  std::uint64_t append_notices_sent = 0;
  std::uint64_t append_notices_received = 0;
  std::uint64_t appends_collapsed = 0; ///< notices given up for a push of the whole value
  std::uint64_t append_gaps = 0;       ///< a notice did not fit what we hold: asked for all of it
  // Dropped.
  std::uint64_t malformed = 0; ///< a message that is no legal tuple, or not the sender's
  std::uint64_t unwanted = 0;  ///< pushed, but nobody here has subscribed
  std::uint64_t outdated = 0;  ///< pushed, but we hold a newer value (TUP-17)
  std::uint64_t refused = 0;   ///< remote writes of reserved keys (TUP-22), commands refused
  std::uint64_t overflow = 0;  ///< tuple space or subscriber table full, value too long
  std::uint64_t append_gaps_given_up = 0; ///< the owner did not send the whole value
  std::uint64_t bad_meta_tuples = 0;      ///< followed, but their text says nothing (META-01)
};

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
  /// To our own tuples that match; `by_other`: reserved ones excluded. Text gets its trailing NUL.
  [[nodiscard]] std::pair<cause, tuple_events> append(const prototype& wanted, const payload& added,
                                                      bool by_other, instant now);
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
  [[nodiscard]] tuple_events on_set(const tuple& x, bool may_write, instant now);
  [[nodiscard]] tuple_events on_subscribe(peer_id source, byte_view octets, instant now);
  [[nodiscard]] tuple_events on_unsubscribe(peer_id source, byte_view octets);
  [[nodiscard]] tuple_events on_append_request(const payload& octets, instant now);
  [[nodiscard]] tuple_events on_append_notice(peer_id source, const payload& octets, instant now);
  /// A set message for one of our tuples; counts what is malformed.
  [[nodiscard]] std::optional<tuple> decode_set(const payload& octets);

  // What happens to hosts and to our own messages.
  /// @param marked it is of our kind: subscriptions to it carry a lifetime and are refreshed
  /// @param incarnation what of an unmarked host that vanished comes back with the same number; 0:
  ///        nothing does
  [[nodiscard]] tuple_events on_host_appeared(peer_id host, bool marked,
                                              std::int32_t incarnation = 0, instant now = {});
  [[nodiscard]] tuple_events on_host_vanished(peer_id host);
  /// Sends all subscriptions to a host again.
  [[nodiscard]] tuple_events renew(peer_id host, bool refresh = true) const;
  /// A message with a request of ours has been acknowledged.
  [[nodiscard]] tuple_events on_delivered(request_id request);
  /// A push, append notice or subscription could not be delivered.
  void on_undelivered(peer_id destination, std::uint16_t port, byte_view head, request_id request,
                      instant now);

  [[nodiscard]] tuple_events on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

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
      if ((!x.expiry || *x.expiry > now) && visit(x.content, x.is_new))
        x.is_new = false;
    });
  }
  [[nodiscard]] bool has_subscriber(const key& name) const;
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

private:
  struct subscription {
    subscription_id id;
    prototype wanted;
    interest kind = interest::subscription;
  };
  /// What another host has subscribed to.
  struct subscriber {
    peer_id host;
    prototype wanted;
    std::optional<instant> expiry; ///< unset for real kernels
  };
  /// A push that failed, until it is likely to have arrived.
  struct failed_push {
    instant first;
    std::optional<instant> tried; ///< unset: to be tried at the next occasion
  };
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
  [[nodiscard]] tuple_events store_own(tuple x);
  tuple_pointer put_own(tuple x);
  void tell_changed(const tuple_pointer& x, tuple_events& out) const;
  void tell_deleted(const tuple_pointer& x, tuple_events& out) const;
  [[nodiscard]] std::vector<subscription_id> interested(const tuple& x) const;
  [[nodiscard]] bool full(const key& name, peer_id owner) const;
  [[nodiscard]] std::optional<instant> expiry_of(const tuple& x) const;
  [[nodiscard]] cause prepare(tuple& x, instant now) const;
  [[nodiscard]] bool replaces(const tuple& x, const tuple& held, bool deletion) const;
  void forget_own(const tuple& gone);

  // tuple_subscriptions.cpp
  void lay_down(peer_id host);
  void push(const tuple& x, tuple_events& out);
  [[nodiscard]] std::vector<peer_id> subscribers_of(const tuple& x) const;
  [[nodiscard]] bool has_subscribed(peer_id host, const tuple& x) const;
  [[nodiscard]] transmit subscribe_message_to(peer_id host, const known_host& known,
                                              const prototype& wanted, bool refresh) const;
  [[nodiscard]] bool first_with(const subscription& x) const;
  [[nodiscard]] bool wanted(const tuple& x) const;
  void schedule_retry(instant now);
  void add_failed_push(peer_id host, const key& name, instant now);
  void refresh(instant now, tuple_events& out);
  void retry_pushes(instant now, tuple_events& out);

  // tuple_appends.cpp
  [[nodiscard]] cause append_to(const tuple_pointer& held, const payload& added, instant now,
                                tuple_events& out);
  void append_whole(tuple next, tuple_events& out);
  void append_notified(const tuple& before, tuple next, const payload& added, instant now,
                       tuple_events& out);
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
  tuple_store store_;
  std::int32_t first_seqno_ = 0; ///< above every number that a deleted own tuple has had
  tuple_channels channels_;

  std::map<subscription_id, subscription> subscriptions_;
  subscription_index<subscription> wanted_; ///< the same, by key
  subscription_index<subscriber> subscribers_;
  std::uint64_t subscribers_version_ = 0;
  std::uint64_t own_keys_version_ = 0;
  std::map<peer_id, known_host> hosts_;
  std::map<peer_id, dormant_host> dormant_;
  std::map<std::pair<peer_id, std::string>, failed_push> failed_;
  std::map<incomplete_key, incomplete> incomplete_;
  std::set<peer_id> renewals_; ///< hosts that may have missed a subscription
  std::optional<instant> next_retry_;
  std::optional<instant> next_refresh_; ///< of our subscriptions, and check of those of others
  std::optional<instant> next_repair_;
  tuple_counters counters_;
};

/// The longest value that fits into a message with the longest MIME type.
inline constexpr std::size_t tuple_value_max =
    std::size_t{16384} * 1024 - tuple_record_size - mimetype_length_max;

} // namespace rubicon::peis
