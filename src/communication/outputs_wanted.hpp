// What a gateway asks a mote to send, because somebody subscribes to it (GW-10, IF-04).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/error.hpp"

namespace rubicon::communication {

/// Stands for every output channel.
inline constexpr std::uint16_t any_channel = 0xffff;

/// Messages on this channel are wanted, this far apart.
struct output_wanted {
  std::uint16_t channel = 0;
  std::chrono::milliseconds period{}; ///< 0: the period of the mote

  friend bool operator==(const output_wanted&, const output_wanted&) = default;
};
RUBICON_FIELDS(output_wanted, channel, period);

/// What is wanted of one channel: the entry of its own before that of any_channel.
[[nodiscard]] std::optional<output_wanted> wanted_on(std::span<const output_wanted> all,
                                                     std::uint16_t channel);

/// Entries that a mote remembers; who wants more wants any_channel.
inline constexpr std::size_t outputs_wanted_max = 4;

/// For each: uint16 channel, uint32 period in ms; network byte order. What is not listed is not
/// wanted. @pre at most outputs_wanted_max; periods below 2^32 ms
[[nodiscard]] bytes encode(const std::vector<output_wanted>& x);

/// Errors: truncated (no whole entries), too_long (above outputs_wanted_max).
[[nodiscard]] result<std::vector<output_wanted>> decode_outputs_wanted(byte_view octets);

} // namespace rubicon::communication
