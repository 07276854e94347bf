// What the Stream System is asked, what it answers, and what it asks of its owner.
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
#include "core/time.hpp"

namespace rubicon::stream {

struct descriptor_tag;
struct channel_tag;

/// A stream of this node, 1..32767: what D1.1 returns beside -1. A closed stream's number comes
/// again only after all others, so that a stale one is refused (STR-05).
using descriptor = strong_id<descriptor_tag, std::uint16_t>;

/// A channel that begins or ends at this node: the owner's number, unique among those.
using channel_handle = strong_id<channel_tag, std::uint32_t>;

/// Records that wait to be read, and octets of the longest, when nothing is said.
inline constexpr std::size_t queue_size_default = 5;
inline constexpr std::size_t buffer_size_default = 12; ///< a sensor_record fits

/// Bits of open_remote's qos. Streams keep the order of their records in any case. With
/// reliable or every_value all records arrive, or the stream ends (stream::streams). The latency
/// class is for who provides the channel: an open fails if no such bound can be given.
inline constexpr std::uint8_t qos_reliable = 0x01;
inline constexpr std::uint8_t qos_ordered = 0x02;
inline constexpr std::uint8_t qos_every_value = 0x04;
inline constexpr std::uint8_t qos_latency_class = 0xf0; ///< four bits, 0: no bound asked for

/// Class 1 is 100 ms at most, each further one twice as much: 15 is 27 minutes. Nothing: not asked.
[[nodiscard]] constexpr std::optional<duration> latency_asked(std::uint8_t qos) {
  const auto level = (qos & qos_latency_class) >> 4U;
  return level == 0 ? std::nullopt : std::optional(50ms * (duration::rep{1} << level));
}

enum class sampling : std::uint8_t { periodic, on_demand };

struct sensor_request {
  std::uint8_t transducer = 0; ///< the node's number for it
  sampling kind = sampling::periodic;
  std::chrono::milliseconds period{1000}; ///< > 0; without meaning on demand
  std::size_t queue_size = queue_size_default;
};

struct remote_request {
  mote_address destination; ///< own_island, own_mote: this node; no_mote: the PC of the island part
  std::uint16_t name = 0;   ///< symbolic, the same at both ends
  std::chrono::milliseconds rate{0}; ///< between two records; 0: at any time
  std::uint8_t qos = 0;
  std::size_t buffer_size = buffer_size_default; ///< octets of the longest record
  std::size_t queue_size = queue_size_default;   ///< at the read end (STR-15)
  /// With this node as destination: this is the write end, of a stream to ourselves. D1.1's call
  /// cannot say so.
  bool writes_to_self = false;
};

/// Why a call did nothing. D1.1 knows FAIL and -1 only.
enum class failure : std::uint8_t {
  bad_descriptor,    ///< no such stream, or no longer
  illegal_operation, ///< reading at the write end, writing at the read end (STR-17)
  no_room,           ///< the table of streams is full (STR-20)
  already_open,
  too_long,
  not_open_yet, ///< open_done is still to come
  bad_argument,
  busy,  ///< a read is pending already
  ended, ///< the other end is gone, and what it has written has been read
};

[[nodiscard]] std::string_view to_string(failure x);

/// Open a channel to `destination`; answered by on_connected() or on_connect_failed().
struct connect_channel {
  descriptor stream;
  mote_address destination;
  std::chrono::milliseconds interval{0}; ///< between two packets; 0: at any time
  std::size_t size = 0;                  ///< octets of a packet at most
  std::uint8_t qos = 0;
};

/// Hand this to the other end of the channel. It may get lost.
struct send_on_channel {
  channel_handle channel;
  bytes octets;
};

/// Close the channel. Its handle is forgotten here: on_channel_closed() need not come.
struct disconnect {
  channel_handle channel;
};

/// Read the transducer now; answered by on_sample().
struct sample {
  descriptor stream;
  std::uint8_t transducer = 0;
};

/// Once for each accepted open_remote() (MCK-02). After a failure the descriptor is stale.
struct open_done {
  descriptor stream;
  std::uint16_t name = 0;
  bool success = false;
};

/// Once for each accepted read() (MCK-07).
struct read_done {
  descriptor stream;
  bytes content; ///< one record, or its beginning; nothing without success
  bool success = false;
};

using output =
    std::variant<connect_channel, send_on_channel, disconnect, sample, open_done, read_done>;
using outputs = std::vector<output>;

/// What a call has led to at once.
struct answer {
  std::optional<failure> refused{}; ///< the call has changed nothing
  descriptor stream{};              ///< of an open
  outputs todo{};
};

} // namespace rubicon::stream
