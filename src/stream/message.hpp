// What the Stream Systems at the two ends of a remote stream say to each other over its channel
// (D1.1 3.3.3.2; STR-13, STR-16): one octet of kind first, network byte order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::stream {

/// 1, SS_OPEN: from the write end; repeated until it is acknowledged. Deviation: of a stream that
/// was open before it says how far that has come, and holds its last records: of those the read
/// end takes what it has not got. A stream that begins says nothing of it.
struct open_message {
  std::uint16_t name = 0;      ///< symbolic, the same at both ends
  std::uint8_t qos = 0;        ///< what of it concerns the read end; 0 is left out
  std::uint16_t sequence = 0;  ///< of the first record of this channel
  std::vector<bytes> recent{}; ///< the last ones before it, each of up to 255 octets

  friend bool operator==(const open_message&, const open_message&) = default;
};

/// 2, SS_OPEN_ACK: from the read end, whether or not its application has opened the stream.
struct open_ack_message {
  std::uint16_t name = 0;

  friend bool operator==(const open_ack_message&, const open_ack_message&) = default;
};

/// 3, SS_WRITE: one record. Deviation: D1.1 has no sequence number; with it the read end counts
/// records that were lost and drops those that come twice or late.
struct write_message {
  std::uint16_t sequence = 0; ///< one more with each; a reliable stream's channel begins with 0
  bytes record;

  friend bool operator==(const write_message&, const write_message&) = default;
};

/// 4, SS_ACK: from the read end of a stream whose records must arrive: it has all before
/// this one.
struct ack_message {
  std::uint16_t next = 0;

  friend bool operator==(const ack_message&, const ack_message&) = default;
};

using message = std::variant<open_message, open_ack_message, write_message, ack_message>;

/// Octets of SS_WRITE before the record.
inline constexpr std::size_t write_header_size = 3;

/// Octets of SS_OPEN before the records, each of which takes one more than its own.
inline constexpr std::size_t open_header_size = 6;

[[nodiscard]] bytes encode(const message& x);

/// Errors: truncated, too_long (octets after a message without a record), bad_value (a quality of
/// service of 0, or a sequence number of 0 without records, that might have been left out),
/// unsupported (unknown kind). How long a record may be the read end decides.
[[nodiscard]] result<message> decode_message(byte_view octets);

} // namespace rubicon::stream
