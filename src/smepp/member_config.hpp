// What a file may say of SMEPP Light: groups, how its motes go about them, and the program `member`
// that uses them (docs/smepp.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "device/transducer_config.hpp"
#include "smepp/crypto/key.hpp"
#include "smepp/events/energy.hpp"
#include "smepp/groups/group_description.hpp"

namespace rubicon::smepp {

/// An event that a member subscribes to, and waits for.
struct wanted_event {
  std::string event;
  double rate = 0;                     ///< in 1/s; 0: at the producers' own rate
  duration from{};                     ///< of the run, at the earliest: before, it may not be in
  std::optional<duration> expires;     ///< expirationTime; nothing: never
  std::optional<duration> until;       ///< of the run: it unsubscribes
  double frequency = 0;                ///< in 1/s, at which its own radio wakes; 0: the rate (A-64)
  std::optional<std::uint8_t> channel; ///< its values go on, to the gateway, on this output channel
};

/// An event that a member raises while somebody subscribes to it.
struct raised_event {
  std::string event;
  /// Its count is the value, big-endian signed 16 bit; nothing: a running number, unsigned 32 bit.
  std::optional<device::quantity> transducer;
  duration every = 10s; ///< for subscriptions without a rate
};

/// A program that is to be a member of a group.
struct member_config {
  std::string group;
  bool creates = false; ///< else it looks for the group until it finds it, and joins
  std::vector<wanted_event> subscribes;
  std::vector<raised_event> raises;
  std::optional<duration> leaves; ///< when, of the run
};

/// What holds for all motes with such programs.
struct group_settings {
  std::vector<group_description> groups; ///< names unique
  std::optional<key> network_key;        ///< nothing: drawn from the seed, as the next one
  std::optional<key> network_mac;
  bool saves_energy = true;
  energy_config energy = {};
  duration event_window = 100ms;     ///< length of a subscription's windows
  bool authenticates_sender = false; ///< by pairwise keys that are drawn from `pairwise_root`,
  std::optional<key> pairwise_root;  ///< or nothing: from the seed
  std::size_t memory_max = 8192;     ///< octets of state of a mote's protocols (SMP-30)
};

} // namespace rubicon::smepp
