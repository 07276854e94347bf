// Tuples as a user writes them, for our own space and for requests to other owners (TUP-05,
// TUP-06).
#pragma once

#include <optional>
#include <utility>

#include "peis/space/tuple_events.hpp"
#include "peis/tuples/tuple_clock.hpp"

namespace rubicon::peis {

/// Checks what a user fills in, and fills in the rest. Keeps no tuple.
class tuple_drafts {
public:
  /// @param clock outlives this
  tuple_drafts(peer_id self, const tuple_clock& clock) : self_(self), clock_(clock) {}

  /// A tuple of that owner from what a user gives; nothing if its expiry cannot be carried.
  [[nodiscard]] std::optional<tuple> draft(peer_id owner, const key& name,
                                           tuple_content content) const;

  /// Fills in creator, time and numbers. A cause other than none: it is no legal tuple.
  [[nodiscard]] cause complete(tuple& x, instant now) const;

  /// The message that asks an owner to set (own_tuples::insert() says what counts) or delete a
  /// tuple.
  [[nodiscard]] std::pair<cause, transmit> ask_to_set(tuple x, request_id request,
                                                      instant now) const;
  [[nodiscard]] std::pair<cause, transmit> ask_to_delete(peer_id owner, const key& name,
                                                         request_id request, instant now) const;

  /// Dates them.
  [[nodiscard]] const tuple_clock& clock() const { return clock_; }

private:
  peer_id self_;
  const tuple_clock& clock_;
};

/// The value of one octet and the expiry in the past that delete a tuple (peis-wire.md 15.4).
void make_deletion(tuple& x);

} // namespace rubicon::peis
