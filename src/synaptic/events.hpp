// What synaptic channels are asked, what they answer, and what they ask of their owner.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "stream/events.hpp"

namespace rubicon::synaptic {

struct descriptor_tag;

/// An end of a synaptic channel at this node, 1..32767: what D1.1 returns beside FAIL. A disposed
/// one's number comes again only after all others, so that a stale one is refused (SYN-05).
using descriptor = strong_id<descriptor_tag, std::uint16_t>;

using stream::channel_handle;
using stream::disconnect;

/// Why a call did nothing. D1.1 knows FAIL only.
enum class failure : std::uint8_t {
  bad_descriptor,    ///< no such channel, or no longer
  illegal_operation, ///< not for this end of the channel
  no_room,           ///< the table is full (SYN-01)
  already_open,      ///< this end of a channel between the same two nodes is
  bad_argument,      ///< size, index or address
  not_open_yet,      ///< create_done is still to come
  not_active,        ///< there is nothing to stop (SYN-07)
  ended,             ///< channel_failed has been reported
};

[[nodiscard]] std::string_view to_string(failure x);

/// Open a channel to `destination`; answered by on_connected() or on_connect_failed().
struct connect_channel {
  descriptor channel;
  mote_address destination;
  std::chrono::milliseconds interval{0}; ///< between two vectors
  std::size_t size = 0;                  ///< octets of a packet at most
  std::uint8_t qos = 0;
};

/// Send this packet over a channel.
struct send_on_channel {
  channel_handle channel;
  bytes octets;
  bool in_slot = false; ///< of channels::set_slot(): a vector, or a stop in its stead
};

/// Once for each accepted create (SYN-02, SYN-04). After a failure the descriptor is stale.
struct create_done {
  descriptor channel;
  bool is_out = false;
  bool success = false;
};

/// missed: the value has not come in time.
enum class input_status : std::uint8_t { updated, missed };

/// syn_input_update: for each index, at each tick at which a vector is due (SYN-10).
struct input_update {
  descriptor channel;
  std::uint8_t index = 0;
  input_status status = input_status::updated;
};

/// The other end is gone (SYN-17). The descriptor is refused by all calls but dispose().
struct channel_failed {
  descriptor channel;
};

using output = std::variant<connect_channel, send_on_channel, disconnect, create_done, input_update,
                            channel_failed>;
using outputs = std::vector<output>;

/// What a call has led to at once.
struct answer {
  std::optional<failure> refused{}; ///< the call has changed nothing
  descriptor channel{};             ///< of a create
  outputs todo{};
};

} // namespace rubicon::synaptic
