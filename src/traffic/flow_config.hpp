// What a file may say about programs that measure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::traffic {

/// When a sender wants to send.
enum class arrivals : std::uint8_t {
  periodic,  ///< every `every`, each up to `jitter` later
  poisson,   ///< independent, `every` apart on average
  saturated, ///< the next as soon as one has ended
};

inline constexpr std::size_t payload_min = 20;  ///< octets of MAC payload
inline constexpr std::size_t payload_max = 116; ///< psdu_max - 9 octets of MAC header - 2 of FCS

/// Sends numbered packets to one mote of its island.
struct sender_config {
  mote_id to;                 ///< the target; broadcast_mote: all receivers
  std::optional<mote_id> via; ///< first hop, a relay; unset: the target. Not if broadcast
  std::size_t payload = 20;   ///< MAC payload, TinyOS's network octet and AM type included
  arrivals pattern = arrivals::periodic;
  duration every = 1s;
  duration jitter = 0s; ///< up to `every`
  /// Of the first, in ecology time; a mote that starts later joins in. Unset: a random moment of
  /// the first `every`; saturated: at once, but for schedule::phase_max in either case.
  std::optional<duration> start;
  std::optional<duration> stop;       ///< nothing is sent at or after it, in ecology time
  std::optional<std::uint64_t> count; ///< at most so many in each life of the mote
  bool ack = true;                    ///< MAC acknowledgement; never for a broadcast
};

/// Passes on what is not for itself.
struct relay_config {
  mote_id next;
  bool ack = true;
};

/// Counts what is for it.
struct receiver_config {};

} // namespace rubicon::traffic
