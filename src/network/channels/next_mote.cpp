#include "network/channels/next_mote.hpp"

#include <cstdint>
#include <limits>

namespace rubicon::network {

namespace {

/// Of a squared distance in virtual coordinates: so much farther the next mote may be where none
/// is nearer. Several motes have the same coordinates, and the route leads round them.
constexpr std::uint32_t sidestep = 5;
constexpr int turns_spare =
    6; ///< turns that set-up may take beside one a hop: many take several hops

/// The one nearest to the destination that is nearer than we are, as far as we know where we are.
/// @param slack the squared distance may be so much greater, and less one
std::optional<mote_id> nearest(const connect_step& x, const std::vector<nearby_mote>& among,
                               const surroundings& around, std::uint32_t slack) {
  if (!x.request.place)
    return std::nullopt;
  std::optional<mote_id> best;
  auto least = around.own_place ? squared_distance(*around.own_place, *x.request.place) + slack
                                : std::numeric_limits<std::uint32_t>::max();
  for (const auto& y : among) {
    if (!y.place || x.has_tried(y.mote) || y.mote == x.previous)
      continue;
    const auto distance = squared_distance(*y.place, *x.request.place);
    if (distance < least) {
      least = distance;
      best = y.mote;
    }
  }
  return best;
}

} // namespace

std::optional<mote_id> next_towards_destination(const connect_step& x, const surroundings& around) {
  const bool is_untried = !x.has_tried(x.request.destination);
  const auto is_destination = [&](const nearby_mote& y) { return y.mote == x.request.destination; };
  for (const auto* among : {&around.motes, &around.heard}) {
    if (std::ranges::any_of(*among, is_destination) && is_untried)
      return x.request.destination;
    if (const auto next = nearest(x, *among, around, 0))
      return next;
  }
  for (const auto* among : {&around.motes, &around.heard}) {
    if (const auto next = nearest(x, *among, around, sidestep))
      return next;
  }
  const bool may_ascend = x.request.place && !around.own_place && around.parent != no_mote &&
                          around.parent != x.previous && !x.has_tried(around.parent);
  return may_ascend ? std::optional(around.parent) : std::nullopt;
}

bool may_be_near(const connect_step& x, const surroundings& around) {
  if (!x.request.place || !around.own_place || x.previous || !x.tried.empty())
    return false;
  return hops_between(*x.request.place, *around.own_place) <= 1;
}

int likely_hops(const surroundings& around, const std::optional<virtual_coordinates>& to) {
  if (!around.own_place || !to)
    return hops_likely;
  return hops_between(*around.own_place, *to) + 1;
}

duration turns_of(const surroundings& around, int hops) {
  return (turns_spare + hops) * around.turn_wait;
}

} // namespace rubicon::network
