// Answers to messages that were addressed to an alias of an island (GW-14).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "core/address.hpp"
#include "core/bytes.hpp"

namespace rubicon::gateway {

/// An island answers from its own id, whichever of its gateways' ids was called; its motes do not
/// know it. Transport's acknowledgements would be taken for somebody else's, so the sender's side
/// remembers what was sent to an alias.
class alias_talks {
public:
  /// A message (the segment of Transport) for `mote` of `island` was addressed to `alias`. The
  /// oldest of talks_max is forgotten.
  void note(island_id alias, island_id island, mote_id mote, byte_view segment);

  /// @returns where a message from `island` for `receiver` is to come from: the alias, if it
  /// answers one that was addressed so, or `island`
  [[nodiscard]] island_id source_of(island_id island, mote_id receiver, byte_view segment) const;

  static constexpr std::size_t talks_max = 256;

private:
  struct talk {
    island_id alias;
    mote_address other;
    mote_id sender;
    std::uint16_t counter = 0;
  };

  std::deque<talk> talks_; ///< the newest last
};

} // namespace rubicon::gateway
