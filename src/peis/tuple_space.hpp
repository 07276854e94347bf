// The tuple space of one peer: its own tuples, copies of others', and who wants what
// (peis-wire.md 15, requirements A11, A12).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/error.hpp"
#include "core/time.hpp"
#include "peis/outgoing_queue.hpp"
#include "peis/subscription_index.hpp"
#include "peis/tuple.hpp"
#include "peis/tuple_record.hpp"
#include "peis/tuple_store.hpp"
#include "peis/types.hpp"

namespace rubicon::peis {

struct tuple_space_config {
  std::size_t tuples_max = 1'000'000;      ///< own and held ones
  std::size_t subscriptions_max = 100'000; ///< of our own
  std::size_t subscribers_max = 100'000;   ///< records of others
  duration lifetime = 60s;                 ///< of our subscriptions at marked hosts; 1..255 s
  duration retry_push = 1s;                ///< a push that failed is tried again (TUP-18)
  duration give_up_push = 30s;
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
  // Dropped.
  std::uint64_t malformed = 0; ///< a message that is no legal tuple, or not the sender's
  std::uint64_t unwanted = 0;  ///< pushed, but nobody here has subscribed
  std::uint64_t outdated = 0;  ///< pushed, but we hold a newer value (TUP-17)
  std::uint64_t refused = 0;   ///< remote sets of reserved keys (TUP-22), commands refused
  std::uint64_t overflow = 0;  ///< tuple space or subscriber table full
};

/// A tuple matching a subscription was set, here or by its owner, also to an equal value (CB-01).
struct tuple_changed {
  subscription_id subscription;
  tuple content;
};

/// It was deleted, has expired or its owner is gone. `content` is the last value known.
struct tuple_deleted {
  subscription_id subscription;
  tuple content;
};

/// To be sent reliably to one peer.
struct transmit {
  peer_id destination;
  std::uint16_t port = 0;
  message_octets content;
  request_id request;
};

/// To be broadcast.
struct transmit_all {
  std::uint16_t port = 0;
  payload octets;
};

using tuple_event = std::variant<tuple_changed, tuple_deleted, transmit, transmit_all>;
using tuple_events = std::vector<tuple_event>;

/// Knows which hosts are there (on_host_appeared, on_host_vanished), but neither links nor routes.
class tuple_space {
public:
  tuple_space() = default;
  tuple_space(tuple_space_config config, peer_id self, duration clock_offset);

  // Commands. A cause other than none means that nothing has been done.
  [[nodiscard]] std::pair<cause, tuple_events> set(const key& name, tuple_content content,
                                                   instant now);
  [[nodiscard]] tuple_events remove(const key& name, instant now);
  /// The message that asks `owner` to set or delete; content unset: delete.
  [[nodiscard]] std::pair<cause, transmit> ask_owner(peer_id owner, const key& name,
                                                     std::optional<tuple_content> content,
                                                     request_id request, instant now) const;
  [[nodiscard]] std::pair<cause, tuple_events> subscribe(peer_id owner, const key& pattern,
                                                         subscription_id id, instant now);
  [[nodiscard]] tuple_events unsubscribe(subscription_id id);

  // Messages of other peers.
  [[nodiscard]] tuple_events on_push(peer_id source, bytes octets, instant now);
  /// Refused unless `may_write` says otherwise for this key of ours.
  [[nodiscard]] tuple_events on_set(const tuple& x, bool may_write, instant now);
  [[nodiscard]] tuple_events on_subscribe(peer_id source, byte_view octets, instant now);
  [[nodiscard]] tuple_events on_unsubscribe(peer_id source, byte_view octets);
  /// A set message for one of our tuples; counts what is malformed.
  [[nodiscard]] std::optional<tuple> decode_set(bytes octets);

  // What happens to hosts and to our own messages.
  /// @param marked it is of our kind: subscriptions to it carry a lifetime and are refreshed
  [[nodiscard]] tuple_events on_host_appeared(peer_id host, bool marked);
  [[nodiscard]] tuple_events on_host_vanished(peer_id host);
  /// Sends all subscriptions to a host again.
  [[nodiscard]] tuple_events renew(peer_id host) const;
  /// A push, subscription or unsubscription could not be delivered.
  [[nodiscard]] tuple_events on_undelivered(peer_id destination, std::uint16_t port, byte_view head,
                                            instant now);

  [[nodiscard]] tuple_events on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] const tuple* find(peer_id owner, const key& name) const;
  [[nodiscard]] std::vector<const tuple*> find_all(peer_id owner, const key& pattern) const;
  [[nodiscard]] bool has_subscriber(const key& name) const;
  [[nodiscard]] timestamp network_time(instant now) const;
  [[nodiscard]] tuple_counters counters() const;

private:
  struct subscription {
    subscription_id id;
    peer_id owner;
    key pattern;
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
  };

  // tuple_space.cpp
  [[nodiscard]] tuple_events store_own(tuple x);
  void tell_changed(const tuple& x, tuple_events& out) const;
  void tell_deleted(const tuple& x, tuple_events& out) const;
  [[nodiscard]] std::vector<subscription_id> interested(const tuple& x) const;
  [[nodiscard]] bool full(const key& name, peer_id owner) const;
  [[nodiscard]] std::optional<instant> expiry_of(const tuple& x) const;
  [[nodiscard]] result<tuple> draft(peer_id owner, const key& name, tuple_content content,
                                    instant now) const;

  // tuple_subscriptions.cpp
  void push(const tuple& x, tuple_events& out);
  [[nodiscard]] bool has_subscribed(peer_id host, const tuple& x) const;
  [[nodiscard]] transmit subscribe_message_to(peer_id host, const known_host& known,
                                              const subscription& x, bool refresh) const;
  [[nodiscard]] bool first_with(const subscription& x) const;
  [[nodiscard]] bool wanted(const tuple& x) const;
  void schedule_retry(instant now);
  void refresh(instant now, tuple_events& out);
  void retry_pushes(instant now, tuple_events& out);

  tuple_space_config config_;
  peer_id self_;
  duration clock_offset_{};
  tuple_store store_;
  std::int32_t first_seqno_ = 0; ///< above every number that a deleted own tuple has had

  std::map<subscription_id, subscription> subscriptions_;
  subscription_index<subscription> wanted_; ///< the same, by key
  subscription_index<subscriber> subscribers_;
  std::map<peer_id, known_host> hosts_;
  std::map<std::pair<peer_id, std::string>, failed_push> failed_;
  std::set<peer_id> renewals_; ///< hosts that may have missed a subscription
  std::optional<instant> next_retry_;
  std::optional<instant> next_refresh_; ///< of our subscriptions, and check of those of others
  tuple_counters counters_;
};

} // namespace rubicon::peis
