// The tuple space of one peer: its own tuples, copies of others', and who wants what
// (docs/peis-wire.md 15).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "core/time.hpp"
#include "peis/link/fair_share.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/space/local_subscriptions.hpp"
#include "peis/space/tuple_audience.hpp"
#include "peis/space/tuple_drafts.hpp"
#include "peis/space/tuple_events.hpp"
#include "peis/space/tuple_space_config.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/tuples/tuple_record.hpp"
#include "peis/tuples/tuple_store.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Hands each command, message and event of a host to the class whose duty it is:
///
///   own_tuples           numbers and dates our tuples; what others write
///   held_tuples          copies of others' tuples; values that lack an append
///   local_subscriptions  what users here have subscribed to, and the questions that it makes
///   subscriber_feed      what other hosts are sent and asked for, as far as there is room
///   tuple_hosts          who may put something here; whose subscriptions are kept
///
/// A change of an own tuple goes to the feed first, then to the users here. Knows which hosts are
/// there (on_host_appeared, on_host_vanished), but neither links nor routes.
class tuple_space {
public:
  using interest = local_subscriptions::interest;

  tuple_space();
  tuple_space(const tuple_space_config& config, peer_id self, duration clock_offset);
  ~tuple_space();
  tuple_space(tuple_space&&) noexcept;
  tuple_space& operator=(tuple_space&&) noexcept;

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
  /// A callback is notified of what arrives, but requests nothing.
  [[nodiscard]] std::pair<cause, tuple_events>
  subscribe(const prototype& wanted, subscription_id id, interest kind, instant now);
  [[nodiscard]] std::pair<cause, tuple_events> unsubscribe(subscription_id id);

  // Messages of other peers.
  /// For port push, append_request, append_notice, subscribe or unsubscribe; nothing comes of one
  /// for another port.
  [[nodiscard]] tuple_events on_message(std::uint16_t port, peer_id source, const payload& octets,
                                        instant now);
  /// A set message for one of our tuples; counts what is malformed.
  [[nodiscard]] std::optional<tuple> decode_set(const payload& octets, instant now);
  /// Refused unless `may_write` says otherwise for this key of ours.
  [[nodiscard]] tuple_events on_set(peer_id source, const tuple& x, bool may_write, instant now);

  // What happens to hosts and to our own messages.
  /// @param marked it is of our kind: subscriptions to it carry a lifetime and are refreshed
  /// @param incarnation what of an unmarked host that vanished comes back with the same number; 0:
  ///        nothing does
  [[nodiscard]] tuple_events on_host_appeared(peer_id host, bool marked, instant now,
                                              std::int32_t incarnation = 0);
  [[nodiscard]] tuple_events on_host_vanished(peer_id host, instant now);
  /// Sends all subscriptions to a host again.
  [[nodiscard]] tuple_events renew(peer_id host, instant now);
  /// A message with a request of ours has been acknowledged.
  [[nodiscard]] tuple_events on_delivered(request_id request, instant now);
  /// A push, append notice or subscription could not be delivered.
  void on_undelivered(peer_id destination, std::uint16_t port, byte_view head, request_id request,
                      instant now);

  [[nodiscard]] tuple_events on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const;

  /// Network time minus ecology time from now on. What is held expires when it was to (SCH-07).
  void set_clock_offset(duration offset);

  // Looking. What has expired is still stored until on_time().
  [[nodiscard]] const tuple_store& stored() const; ///< own and held tuples
  [[nodiscard]] tuple_audience audience() const;   ///< who watches our own
  /// What a user writes, for insert() and for other owners.
  [[nodiscard]] const tuple_drafts& drafts() const;
  /// Does the present value of an own tuple still wait for room to be sent to a subscriber? Another
  /// one would overtake it.
  [[nodiscard]] bool is_waiting(const key& name) const;
  [[nodiscard]] std::uint64_t own_keys_version() const; ///< of each set of own keys another
  [[nodiscard]] tuple_counters counters() const;

  /// What others have put here counts against it; others who keep what they send may use it too.
  [[nodiscard]] const std::shared_ptr<fair_share>& memory() const;
  /// What the calls since the last time have cost, beyond one unit for each event they returned.
  [[nodiscard]] work_units take_work();

private:
  struct parts;

  std::unique_ptr<parts> parts_; ///< they refer to each other: they stay where they are
};

} // namespace rubicon::peis
