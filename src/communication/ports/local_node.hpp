// The node that a Communication Layer belongs to, as all ports of the layer see it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "communication/ports/layer_output.hpp"
#include "communication/process.hpp"
#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"

namespace rubicon::communication {

inline constexpr std::uint8_t transducers_max = 32; ///< bits of a mask

[[nodiscard]] constexpr bool has_transducer(std::uint32_t mask, std::uint8_t number) {
  return number < transducers_max && (mask & (1U << number)) != 0;
}

/// Of the layer itself.
struct own_layer_config {
  mote_id self;                      ///< no_mote: a PC
  island_id home = own_island;       ///< accounts for what is sent before the node has joined one
  std::uint32_t incarnation = 0;     ///< how often this node has been started before
  std::uint32_t transducer_mask = 0; ///< bit n: there is a transducer n
  std::size_t unclaimed_max = 4;     ///< accepted channels that have carried nothing yet
  /// From a tick to its vectors at least: so long programs may take.
  static constexpr duration slot_min = 200us;
};

struct layer_counters {
  std::uint64_t unowned = 0;         ///< messages of an AM type that no program provides (AM-01)
  std::uint64_t offered = 0;         ///< messages, accepted or refused
  std::uint64_t unjoined = 0;        ///< of them, refused for want of a join
  std::uint64_t misaddressed = 0;    ///< of them, refused: no valid destination
  std::uint64_t refused = 0;         ///< commands that returned FAIL
  std::uint64_t before_join = 0;     ///< of them, for want of a join (MCK-16)
  std::uint64_t unknown_channel = 0; ///< packets on a channel number without a user
  std::uint64_t unclaimed = 0;       ///< accepted channels given up
  std::uint64_t too_slow = 0;  ///< channels given up: their route promises less than was asked
  std::uint64_t malformed = 0; ///< requests of outputs that could not be decoded
};
RUBICON_FIELDS(layer_counters, unowned, offered, unjoined, misaddressed, refused, before_join,
               unknown_channel, unclaimed, too_slow, malformed);

/// The state that all ports of a layer share.
struct local_node {
  own_layer_config config{};
  bool initialised = false;
  std::optional<island_id> island{}; ///< nothing: it has not joined
  instant now{};                     ///< of the input or command that is handled
  std::optional<duration> network_ahead{};
  layer_outputs outputs{}; ///< not yet taken by the owner
  layer_counters counters{};

  [[nodiscard]] mote_address address() const { return {island.value_or(own_island), config.self}; }

  /// Counts a command that fails.
  status refuse() {
    ++counters.refused;
    return FAIL;
  }

  /// Whether it has joined; counted if not.
  [[nodiscard]] bool may_send() {
    if (island)
      return true;
    ++counters.before_join;
    return false;
  }
};

} // namespace rubicon::communication
