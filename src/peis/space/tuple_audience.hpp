// Who watches our own tuples: others and users of this peer (TUP-23).
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "peis/space/local_subscriptions.hpp"
#include "peis/subscribers/subscriber_table.hpp"

namespace rubicon::peis {

/// A view of the subscriptions here. What it looks at outlives it.
class tuple_audience {
public:
  tuple_audience(const local_subscriptions& local, const subscriber_table& others)
      : local_(local), others_(others) {}

  /// Is there a subscription, here or elsewhere, to our tuple of this key?
  [[nodiscard]] bool has_subscriber(const key& name) const {
    return others_.covers(name) || local_.wants_own(name);
  }
  [[nodiscard]] bool is_watched(const key& name) const { ///< or a callback here
    return others_.covers(name) || local_.watches_own(name);
  }
  [[nodiscard]] bool has_subscription(subscription_id id) const { ///< or callback, of ours
    return local_.contains(id);
  }

  /// Who has subscribed to what here, ascending by host, owner, key.
  [[nodiscard]] std::vector<std::pair<peer_id, prototype>> subscribers() const {
    return others_.all();
  }

  /// Folded keys and patterns of subscriptions to our own tuples, others' and ours, whose first
  /// part is this one and no wildcard; ascending, each once. @param first_part in lower case
  [[nodiscard]] std::set<std::string> subscribed(std::string_view first_part) const;

  /// Changes whenever subscriptions and callbacks, ours or others', do.
  [[nodiscard]] std::uint64_t version() const { return local_.version() + others_.version(); }

private:
  const local_subscriptions& local_;
  const subscriber_table& others_;
};

} // namespace rubicon::peis
