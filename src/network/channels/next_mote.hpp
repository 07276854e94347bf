// Which neighbour a connect message goes to (NET-10).
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "network/channels/channel_message.hpp"
#include "network/places/coordinates.hpp"

namespace rubicon::network {

/// A good neighbour, and where it is if that is known.
struct nearby_mote {
  mote_id mote;
  std::optional<virtual_coordinates> place;
};

/// What greedy forwarding knows of the surroundings.
struct surroundings {
  std::optional<virtual_coordinates> own_place;
  std::vector<nearby_mote> motes; ///< good neighbours (NET-10)
  std::vector<nearby_mote> heard; ///< other neighbours, of whose links too little is known
  mote_id parent = no_mote;       ///< in the tree
  bool is_crowd = false;          ///< there may be more than the table of neighbours holds
  bool is_new = false;            ///< we have started lately: more neighbours may be there
  duration beacon_wait = 1s;      ///< within which neighbours beacon that have just started, or see
                                  ///< that we have
  duration turn_wait{};           ///< that a frame may have to wait before it leaves, at each hop
};

/// A connect message at one mote.
struct connect_step {
  std::optional<mote_id> previous; ///< nothing at the source
  connect_message request;         ///< as it came to us; once open, with the hops of the path
  std::vector<mote_id> tried;      ///< were a dead end, or did not answer

  [[nodiscard]] bool has_tried(mote_id x) const {
    return std::ranges::find(tried, x) != tried.end();
  }
};

/// The next mote: the destination, if it is a good neighbour; else a good one that is nearer to it.
/// Where there is none, the same among other neighbours: one that has just started is not a good
/// one yet. Then one that is about as far from it as we are, a good one first. Who does not know
/// where it is itself leaves it to the mote above it in the tree.
[[nodiscard]] std::optional<mote_id> next_towards_destination(const connect_step& x,
                                                              const surroundings& around);

/// Whether the source may be heard by the destination itself, though that is no neighbour that it
/// knows.
[[nodiscard]] bool may_be_near(const connect_step& x, const surroundings& around);

/// Of a channel to a destination there, about.
[[nodiscard]] int likely_hops(const surroundings& around,
                              const std::optional<virtual_coordinates>& to);
inline constexpr int hops_likely = 8; ///< of a route that is not known

/// What a message over so many hops and its answer may wait for their turns.
[[nodiscard]] duration turns_of(const surroundings& around, int hops);

} // namespace rubicon::network
