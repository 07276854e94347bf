// The tuple messages: a record of 224 octets, the MIME type, the value (peis-wire.md 15.1, 15.2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "peis/tuple.hpp"

namespace rubicon::peis {

inline constexpr std::size_t tuple_record_size = 224;

/// Which tuples somebody wants: unset fields, any_peer and patterns match everything.
struct prototype {
  peer_id owner = any_peer;
  key name;
  peer_id creator = any_peer;
  encoding form = encoding::any;
  std::optional<std::string> mimetype;
  std::optional<payload> value; ///< compared without letter case up to the first NUL

  [[nodiscard]] bool matches(const tuple& x) const;

  /// The same subscription, whoever repeats it (peis-wire.md 15.6).
  friend bool operator==(const prototype& a, const prototype& b);
};

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

/// The octets after the head: the value, or one zero octet for an empty one (TUP-02).
[[nodiscard]] payload encode_tuple_value(const tuple& x);

/// Decodes a push or set message, whose octets become the value. Refused as bad_value unless it is
/// concrete: owner, creator, times, encoding and key without wildcards, MIME type and value present
/// (peis-wire.md 15.3).
[[nodiscard]] result<tuple> decode_tuple_message(bytes octets);

[[nodiscard]] bytes encode(const subscribe_message& message);
[[nodiscard]] result<subscribe_message> decode_subscribe(byte_view octets);

/// The record alone; of what arrives only owner and key are meaningful (peis-wire.md 15.2).
[[nodiscard]] bytes encode_unsubscribe(const prototype& unwanted);
[[nodiscard]] result<prototype> decode_unsubscribe(byte_view octets);

/// The key in a record; for messages that come back undelivered.
[[nodiscard]] result<key> decode_record_key(byte_view record);

} // namespace rubicon::peis
