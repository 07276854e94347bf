// Subscriptions to what meta tuples point at (docs/peis-wire.md 17, META-02).
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "core/time.hpp"
#include "peis/space/tuple_events.hpp"
#include "peis/space/tuple_space.hpp"
#include "peis/tuples/meta_tuple.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// For each indirect subscription of the user one of our own to the meta tuple, whose events come
/// to on_meta_tuple(); the user's id subscribes to the present target. The ids of our own are
/// own_ids_first and above.
class indirections {
public:
  /// Subscribes to the meta tuple. @pre !contains(id)
  [[nodiscard]] std::pair<cause, tuple_events> begin(const prototype& meta, subscription_id id,
                                                     tuple_space::interest kind, tuple_space& space,
                                                     instant now);

  /// For a new callback: the meta tuple as it is held, of which the space does not notify.
  [[nodiscard]] tuple_events on_held(subscription_id id, const tuple& content, tuple_space& space,
                                     instant now);

  /// A meta tuple has another value, or is gone (nullptr): drops the old target before anything of
  /// it can follow, then subscribes to the new one.
  [[nodiscard]] tuple_events on_meta_tuple(subscription_id meta_watch, const tuple* content,
                                           tuple_space& space, instant now);

  /// @pre contains(id)
  [[nodiscard]] tuple_events end(subscription_id id, tuple_space& space);

  [[nodiscard]] bool contains(subscription_id id) const { return by_id_.contains(id); }
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; } ///< meta tuples

private:
  struct indirection {
    tuple_space::interest kind = tuple_space::interest::subscription;
    subscription_id meta_watch; ///< ours, of the meta tuple
    meta_reference target;      ///< what the user's id subscribes to now
  };

  std::map<subscription_id, indirection> by_id_;            ///< the user's
  std::map<subscription_id, subscription_id> meta_watches_; ///< ours, to the user's
  std::uint64_t meta_watches_made_ = 0;
  std::uint64_t malformed_ = 0;
};

} // namespace rubicon::peis
