// The air: the radio medium of one place and the radios in it (docs/architecture.md, Actors).
#pragma once

#include <vector>

#include "actors/base/frame_observer.hpp"
#include "actors/base/timer.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/supervision.hpp"
#include "radio/channel/channel.hpp"
#include "radio/medium/interferer.hpp"

namespace rubicon {

/// A source of noise at work, and what it has been asked to do since.
struct noise_at_work {
  radio::radio_index from;
  radio::interferer what;
};

/// From the fault plan: copies are lost until then.
struct loss_at_work {
  std::uint32_t name = 0; ///< as the channel calls it
  instant until;
};

struct air_state {
  static constexpr std::uint8_t fault_timer = 2;

  radio::channel channel;
  frame_observer observe;
  std::vector<radio_user_actor> users; ///< by radio index; empty until attached
  std::vector<mote_address> addresses; ///< by radio index
  std::vector<bool> tells_energy;      ///< by radio index: it is a mote's that is there
  std::vector<noise_at_work> noises;
  std::vector<loss_at_work> losses;
  std::uint64_t noises_so_far = 0;
  std::uint64_t seed = 0; ///< of their random numbers
  ecology_actor ecology;
  timer wake;
  timer fault_wake{fault_timer};
};

/// Radios that only the fault plan knows, behind the others of their channel.
struct extra_radios {
  std::size_t motes =
      0; ///< those of second motes, and of motes that come from elsewhere: off at first
  std::size_t noises = 0; ///< and behind them those of no mote
};

/// Owns every radio of `channel`. @param addresses whose radio each is, by radio index; the PAN of
/// a radio is its island's id
/// @param extra how many of the last ones are not those of motes from the start
/// @param seed of random numbers that only faults need
/// @param observe may be empty
air_actor::behavior_type air(scheduler::actor_pointer<air_state, air_actor> self,
                             radio::channel channel, std::vector<mote_address> addresses,
                             extra_radios extra, std::uint64_t seed, ecology_actor ecology,
                             frame_observer observe);

} // namespace rubicon
