// What the users of this peer have subscribed to (TUP-08, CB-01).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.hpp"
#include "peis/space/tuple_events.hpp"
#include "peis/subscribers/subscription_index.hpp"
#include "peis/tuples/tuple.hpp"

namespace rubicon::peis {

/// Subscriptions and callbacks of ours by id and by key, and the questions that they make: equal
/// subscriptions are one question, which other hosts are asked once. What is sent, and when, is
/// decided elsewhere (subscriber_feed).
class local_subscriptions {
public:
  /// A callback is notified of what arrives, but requests nothing.
  enum class interest : std::uint8_t { subscription, callback };

  struct subscription {
    subscription_id id;
    prototype wanted;
    interest kind = interest::subscription;
  };

  struct question {
    prototype wanted;
    std::uint64_t serial = 0; ///< ascending in the order in which they came
    std::size_t askers = 0;
  };

  struct addition {
    cause why = cause::none;           ///< other than none: nothing has been added
    const question* unasked = nullptr; ///< the question it makes, if it is the first of its kind
  };

  /// @param lifetime of our subscriptions at marked hosts; 1..255 s
  local_subscriptions(peer_id self, std::size_t max, duration lifetime)
      : self_(self), max_(max), lifetime_(lifetime) {}

  [[nodiscard]] addition add(const prototype& wanted, subscription_id id, interest kind);
  std::optional<subscription> remove(subscription_id id); ///< nothing if there is none

  [[nodiscard]] bool contains(subscription_id id) const { return by_id_.contains(id); }
  [[nodiscard]] std::size_t size() const { return by_id_.size(); }
  [[nodiscard]] std::uint64_t version() const { return version_; } ///< of each change another

  /// Is there a subscription with this owner and key, whatever the other fields?
  [[nodiscard]] bool subscribes_to(peer_id owner, const key& wanted) const;

  /// Does a subscription, not a callback alone, match this tuple?
  [[nodiscard]] bool wants(const tuple& x) const;

  /// Does a subscription concern our own tuple of this key? A subscription or a callback?
  [[nodiscard]] bool wants_own(const key& name) const;
  [[nodiscard]] bool watches_own(const key& name) const;

  /// Calls `visit(const subscription&)` for subscriptions to our own tuples under this first part,
  /// in lower case.
  template <class Visitor>
  void for_own_under(std::string_view first_part, Visitor visit) const {
    by_key_.for_first_part(first_part, [&](const subscription& x) {
      if (x.kind == interest::subscription && concerns_own(x))
        visit(x);
    });
  }

  /// One event for each subscription and callback that the tuple concerns, ascending by id.
  void notify_changed(const tuple_pointer& x, tuple_events& out) const;
  void notify_deleted(const tuple_pointer& x, tuple_events& out) const;

  [[nodiscard]] bool has_questions() const { return !questions_.empty(); }
  [[nodiscard]] const question* find_question(std::uint64_t serial) const; ///< null if it is gone
  /// The first with this serial or a later one; null if there is none.
  [[nodiscard]] const question* next_question(std::uint64_t serial) const;

  /// The message that asks a host. @param marked it is of our kind: the subscription has a lifetime
  /// @param refresh it need not send what matches again if it knows the subscription
  [[nodiscard]] transmit request_to(peer_id host, bool marked, const prototype& wanted,
                                    bool refresh) const;

private:
  [[nodiscard]] bool concerns_own(const subscription& x) const {
    return x.wanted.owner == any_peer || x.wanted.owner == self_;
  }
  [[nodiscard]] std::vector<subscription_id> interested(const tuple& x) const;
  const question* add_question(const prototype& wanted);
  void remove_question(const prototype& wanted);

  peer_id self_;
  std::size_t max_;
  duration lifetime_;
  std::map<subscription_id, subscription> by_id_;
  subscription_index<subscription> by_key_;
  std::map<std::string, question> questions_; ///< by identity
  std::map<std::uint64_t, const question*> by_serial_;
  std::uint64_t next_serial_ = 0;
  std::uint64_t version_ = 0;
};

} // namespace rubicon::peis
