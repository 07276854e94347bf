// Tuple messages: a record of 224 octets, the MIME type, the value (docs/peis-wire.md 15.1, 15.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "peis/tuples/tuple.hpp"

namespace rubicon::peis {

inline constexpr std::size_t tuple_record_size = 224;

/// How long a subscription lives without being repeated. Our own kind says so in the word that real
/// kernels fill with "force resend" and ignore: `R` `L`, refresh 1, seconds 1.
struct lifetime_tag {
  bool refresh = false; ///< a repeat: what was pushed once need not be pushed again
  std::uint8_t seconds = 60;

  friend bool operator==(const lifetime_tag&, const lifetime_tag&) = default;
};

struct subscribe_message {
  prototype wanted;
  std::optional<lifetime_tag> lifetime; ///< unset for real kernels
};

/// Record and MIME type of a push or set message, to which the value is to be appended. Fields of
/// the two differ in the octet order of "has data" only.
enum class tuple_message_kind : std::uint8_t { push, set };
[[nodiscard]] bytes encode_tuple_head(const tuple& x, tuple_message_kind kind);

// Of the seconds of `written` and `expiry` the wire has the low 32 bits. The decoder's caller says
// what the time is: of all with these bits the nearest is meant. The three values with a meaning of
// their own keep it, and no other time is written as one of them. `user_time` is an application's
// own.

/// The octets after the head: the value, or one zero octet for an empty one (TUP-02).
[[nodiscard]] payload encode_tuple_value(const tuple& x);

/// Decodes a push or set message; the value shares its octets. Refused as bad_value unless it is
/// concrete: owner, creator, times, encoding and key without wildcards, MIME type and value present
/// (docs/peis-wire.md 15.3).
/// @param known our network time
[[nodiscard]] result<tuple> decode_tuple_message(const payload& octets, timestamp known);

/// Asks an owner to append to those of its tuples that match (docs/peis-wire.md 15.2, 15.5).
struct append_request {
  prototype wanted; ///< a MIME type cannot travel
  payload added;
};

/// Record, length and prototype's value of a request, to which the added octets are to be appended.
/// @pre no MIME type
[[nodiscard]] bytes encode_append_request_head(const append_request& message);
[[nodiscard]] result<append_request> decode_append_request(const payload& octets, timestamp known);

/// Notifies a subscriber of what an owner has appended.
struct append_notice {
  peer_id owner;
  key name;
  std::int32_t seqno = 0;        ///< of the tuple, before and after
  std::int32_t append_seqno = 0; ///< before
  std::size_t length = 0;        ///< of the value before
  payload added;
};

/// Record and length of a notice, to which `added` octets are to be appended.
/// @param before the tuple before the change
[[nodiscard]] bytes encode_append_notice_head(const tuple& before, std::size_t added);
[[nodiscard]] result<append_notice> decode_append_notice(const payload& octets);

[[nodiscard]] bytes encode(const subscribe_message& message);
[[nodiscard]] result<subscribe_message> decode_subscribe(byte_view octets, timestamp known);

/// The record alone; of what arrives only owner and key are meaningful (docs/peis-wire.md 15.2).
[[nodiscard]] bytes encode_unsubscribe(const prototype& unwanted);
[[nodiscard]] result<prototype> decode_unsubscribe(byte_view octets);

/// The key in a record; for messages that come back undelivered.
[[nodiscard]] result<key> decode_record_key(byte_view record);

} // namespace rubicon::peis
