// What other hosts are sent of our tuples and asked for (docs/peis-wire.md 15.6, TUP-10, TUP-18).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "peis/link/neighbour_budget.hpp"
#include "peis/space/local_subscriptions.hpp"
#include "peis/space/own_tuples.hpp"
#include "peis/space/pending_feeds.hpp"
#include "peis/space/tuple_channels.hpp"
#include "peis/space/tuple_events.hpp"
#include "peis/space/tuple_hosts.hpp"
#include "peis/space/tuple_space_config.hpp"
#include "peis/subscribers/push_window.hpp"
#include "peis/subscribers/subscriber_table.hpp"
#include "peis/tuples/tuple_record.hpp"

namespace rubicon::peis {

/// Sends each change of an own tuple to the hosts that have subscribed to it, and our questions to
/// all hosts, as far as each host's window has room. What has no room, or was not delivered, is
/// pending: of a value only the newest is sent, and a host that misses too many values is sent all
/// that matches again, a piece at a time (a queue scan). Appends leave in order (tuple_channels).
class subscriber_feed {
public:
  /// @param pool octets of all that others have put here. `own`, `hosts` and `local` outlive this
  subscriber_feed(const tuple_space_config& config, peer_id self, own_tuples& own,
                  tuple_hosts& hosts, const local_subscriptions& local,
                  std::shared_ptr<fair_share> pool);

  subscriber_feed(const subscriber_feed&) = delete;
  subscriber_feed& operator=(const subscriber_feed&) = delete;

  /// May subscribers be sent what is added to this tuple alone? Not before all have been sent
  /// a whole value whose arrival is watched; not if one asked for certain values; an empty
  /// value travels in a form that nothing can be added to.
  [[nodiscard]] bool takes_notices(const tuple& held) const;
  void publish(const own_change& x, instant now, tuple_events& out);
  void on_expired(const key& name); ///< of an own tuple: subscribers know when it does

  /// Another host subscribes, if it may put something here. A refresh of what is known is not
  /// answered.
  void subscribe(peer_id source, const prototype& wanted, std::optional<lifetime_tag> lifetime,
                 instant now, tuple_events& out);
  void unsubscribe(peer_id source, peer_id owner, const key& wanted);

  /// A subscription of ours was added. @param unasked its question, to be sent to all it concerns
  void ask(const local_subscriptions::question* unasked, instant now, tuple_events& out);
  /// Sends all our questions to a host again.
  /// @param refresh it need not send what they match again if it knows them
  void ask_all(peer_id host, bool refresh, instant now, tuple_events& out);

  /// There is a route to it now: what is pending leaves, and it is asked everything.
  void on_host_appeared(peer_id host, instant now, tuple_events& out);
  void on_host_gone(peer_id host);

  /// A message with a request of ours was acknowledged, or could not be delivered.
  void on_delivered(request_id request, instant now, tuple_events& out);
  void on_undelivered(peer_id destination, std::uint16_t port, byte_view head, request_id request,
                      instant now);

  /// Repeats ours at marked hosts, and ends those of marked hosts that were not repeated.
  void refresh(instant now, tuple_events& out);
  /// One turn for pending feeds: who has waited longest first, a slice each, round and round.
  void serve_pending(instant now, tuple_events& out);
  /// When either is due.
  [[nodiscard]] std::optional<instant> deadline() const {
    return earliest(next_refresh_, feeds_.deadline());
  }

  /// Does the present value of an own tuple still wait for room to be sent to a subscriber?
  [[nodiscard]] bool is_waiting(const key& name) const;
  [[nodiscard]] const subscriber_table& subscribers() const { return subscribers_; }
  [[nodiscard]] tuple_counters counters() const;
  [[nodiscard]] work_units take_work() { return work_.take(); }

private:
  /// One host's pending feed while it is looked at.
  struct scan {
    peer_id host;
    pending_feed& feed;
    std::size_t steps; ///< left
    instant now;
    tuple_events& out;

    void take(std::size_t some) { steps -= steps < some ? steps : some; }
  };

  // subscriber_feed.cpp
  void publish_one(const own_value_set& x, instant now, tuple_events& out);
  void publish_one(const own_value_deleted& x, instant now, tuple_events& out);
  void publish_one(const own_value_extended& x, instant now, tuple_events& out);
  void publish_one(const own_value_appended& x, instant now, tuple_events& out);
  void push(const tuple& x, instant now, tuple_events& out);
  [[nodiscard]] pending_feed* find_unreached(peer_id host, instant now);
  void miss_unreached(peer_id host, pending_feed& feed, const tuple& changed);
  void miss(peer_id host, const key& name, std::optional<instant> failing_since);
  void retry_later(peer_id host, const key& name, instant failing_since, instant now);
  void resynchronise(peer_id host);
  void begin_queue_scan(subscriber& x);
  void end_queue_scan(peer_id host, std::uint64_t number);
  void begin_question_scan(peer_id host, bool refresh);
  void collapse(const key& name, instant now);
  void transmit_in_order(const key& name, transmit message, tuple_events& out);

  // subscriber_feed_scan.cpp
  [[nodiscard]] static transmit push_message(const tuple& x, peer_id subscriber);
  [[nodiscard]] transmit in_flight(transmit message, std::optional<std::uint64_t> question,
                                   std::optional<instant> failing_since);
  void plan(peer_id host, instant now);
  void serve_now(peer_id host, instant now, tuple_events& out);
  void serve(scan& x);
  [[nodiscard]] bool is_blocked(scan& x, std::size_t octets) const;
  [[nodiscard]] bool send_questions(scan& x);
  [[nodiscard]] bool send_undelivered(scan& x);
  [[nodiscard]] bool scan_queue(scan& x);
  void push_scanned(scan& x, const key& name);

  tuple_space_config config_;
  peer_id self_;
  own_tuples& own_;
  tuple_hosts& hosts_;
  const local_subscriptions& local_;
  subscriber_table subscribers_;
  push_window window_;
  tuple_channels channels_;
  pending_feeds feeds_;
  std::optional<instant> next_refresh_;
  work_meter work_;
  tuple_counters counters_;
};

} // namespace rubicon::peis
