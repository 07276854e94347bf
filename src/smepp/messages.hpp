// What peers say to each other. Each message fits one frame beside counter and MAC: nothing is ever
// fragmented. Network byte order; the first octet says which message follows. A text is its length
// (uint8) and as many printable ASCII characters; a time is 6 octets (group_time.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "smepp/crypto/agreement.hpp"
#include "smepp/crypto/cipher.hpp"
#include "smepp/crypto/security.hpp"
#include "smepp/crypto/session_keys.hpp"
#include "smepp/group_id.hpp"
#include "smepp/groups/group_description.hpp"
#include "smepp/groups/group_time.hpp"
#include "smepp/peer_description.hpp"

namespace rubicon::smepp {

inline constexpr std::size_t event_name_max = 32;  ///< characters
inline constexpr std::size_t event_value_max = 64; ///< octets

// ---- at network level, one hop

/// 0x01, to all: which groups are there? uint64 nonce, uint8 flags (bit 0: closed, 1: private are
/// asked for; 2, 3: what they are to be; 4: a proof follows, 5: a name), proof (8), name.
struct discover {
  std::uint64_t nonce = 0; ///< never used before by its sender
  std::optional<bool> is_closed;
  std::optional<bool> is_private;
  std::optional<tag> proof; ///< of the key of a private or closed group
  std::string name;         ///< empty: any

  friend bool operator==(const discover&, const discover&) = default;
};

/// 0x02, to who asked: one of the groups of the sender, who can admit to it. uint64 nonce, uint16
/// group, uint8 flags (bit 0: closed, 1: private, 2: a proof follows), uint8 members, uint16 period
/// and uint16 length of the management cycle in ms, time, proof (8) of all that, name, which in a
/// private group is encrypted under its master key. Who has shown the group's key gets a proof.
struct answer {
  std::uint64_t nonce = 0; ///< of the question
  group_id group;
  bool is_closed = false;
  bool is_private = false;
  std::uint8_t members = 0;
  std::uint16_t period_ms = 0;
  std::uint16_t length_ms = 0;
  group_time time;          ///< when this was handed to the radio
  std::optional<tag> proof; ///< that the sender knows the key of the group
  bytes name;               ///< 1..group_description::name_max

  friend bool operator==(const answer&, const answer&) = default;
};

/// 0x03: may I join? uint16 group, uint32 nonce.
struct join {
  group_id group;
  std::uint32_t nonce = 0;

  friend bool operator==(const join&, const join&) = default;
};

/// 0x04: prove it. uint16 group, uint32 nonce of the join, cookie (8): all that its sender wants
/// back before it remembers or computes anything for who has asked.
struct join_challenge {
  group_id group;
  std::uint32_t nonce = 0;
  tag cookie{};

  friend bool operator==(const join_challenge&, const join_challenge&) = default;
};

/// 0x05: uint16 group, uint32 nonce, cookie, uint32 transducers, uint8 flags (bit 0: the sender is
/// a member, and only lacks the present keys), 32 octets of key share for this handshake, 32 octets
/// of key share that is the sender's for good, MAC of all that and the group's terms under the
/// credential (8).
struct join_proof {
  group_id group;
  std::uint32_t nonce = 0;
  tag cookie{};
  transducer_mask transducers = 0;
  bool is_member = false;
  key_share share{};
  key_share identity{};
  tag proof{};

  friend bool operator==(const join_proof&, const join_proof&) = default;
};

/// A pair of session keys, encrypted and authenticated under a key for this one time: uint16
/// generation, uint16 maker, uint24 ms until it is used for sending, 32 octets of keys, MAC (8) of
/// all that and of what the carrier adds.
struct wrapped_keys {
  static constexpr std::uint32_t send_in_max = 0xff'ffff; ///< 4.6 h

  session_id id;
  std::uint32_t send_in_ms = 0;
  std::array<std::uint8_t, 2 * key::size> octets{};
  tag mac{};

  friend bool operator==(const wrapped_keys&, const wrapped_keys&) = default;
};

/// 0x06: welcome. uint16 group, uint32 nonce of the join, 32 octets of key share, wrapped keys,
/// uint8 members and uint8 subscriptions that will follow, time.
struct join_accept {
  group_id group;
  std::uint32_t nonce = 0;
  key_share share{};
  wrapped_keys keys;
  std::uint8_t members = 0;
  std::uint8_t subscriptions = 0;
  group_time time; ///< when this was made

  friend bool operator==(const join_accept&, const join_accept&) = default;
};

/// Why a primitive failed; join_refuse carries the first three.
enum class failure : std::uint8_t {
  wrong_master_key = 1,
  group_full = 2,
  not_admitted = 3, ///< by the member's policy
  unknown_group,
  no_answer,
  no_room, ///< a table here is full
  not_a_member,
  bad_argument,
  name_taken,
};
[[nodiscard]] std::string_view to_string(failure x);

/// 0x07: no. uint16 group, uint32 nonce of the join, uint8 why, MAC of the handshake under the
/// credential (8). Of who has another key it is advice only.
struct join_refuse {
  group_id group;
  std::uint32_t nonce = 0;
  failure why = failure::not_admitted;
  tag mac{};

  friend bool operator==(const join_refuse&, const join_refuse&) = default;
};

// ---- inside a group

/// What members know of one that is or was there: uint16 peer, uint32 transducers, uint16 stamp,
/// uint8 1 if it has left, 8 octets of its identity. Of two entries that of the newer stamp holds
/// (RFC 1982).
struct member {
  peer_description who;
  std::uint16_t stamp = 0;
  bool has_left = false;
  tag identity{}; ///< short_hash of the key share that is its own for good

  friend bool operator==(const member&, const member&) = default;
};

/// 0x10: someone has joined; who has not known sends it on. The entry.
struct member_joined {
  member who;

  friend bool operator==(const member_joined&, const member_joined&) = default;
};

/// 0x11: someone has left; who has not known sends it on. The entry.
struct member_left {
  member who;

  friend bool operator==(const member_left&, const member_left&) = default;
};

/// 0x12, to one: members that the sender knows. uint8 count, the entries.
struct member_list {
  std::vector<member> all; ///< 1..count_max

  static constexpr std::size_t entry_size = 17;
  static constexpr std::size_t count_max = (message_max - 2) / entry_size;

  friend bool operator==(const member_list&, const member_list&) = default;
};

/// Identifies a subscription within its group.
struct subscription_id {
  mote_id subscriber;
  std::uint8_t number = 0; ///< from 1

  friend auto operator<=>(const subscription_id&, const subscription_id&) = default;
};

/// 0x13, 0x14 (refresh: the same, again): uint16 subscriber, uint8 number, uint16 round, uint8
/// hops, time made, time of expiry, uint32 interval in ms (0: no rate), name. Each member sends a
/// round on once, and again if it receives it over fewer hops: the tree of the subscription.
struct subscribe {
  subscription_id id;
  std::uint16_t round = 0; ///< one more with each refresh; wraps (RFC 1982)
  std::uint8_t hops = 0;   ///< from the subscriber to the sender
  group_time made_at;
  group_time expires;
  std::uint32_t interval_ms = 0;
  std::string name;
  bool is_refresh = false;

  friend bool operator==(const subscribe&, const subscribe&) = default;
};

/// 0x15: uint16 subscriber, uint8 number, time made; who knows it sends it on.
struct unsubscribe {
  subscription_id id;
  group_time made_at;

  friend bool operator==(const unsubscribe&, const unsubscribe&) = default;
};

/// That its producer has raised an event, once: uint64 number, which the producer uses but once,
/// MAC (8) under the key that it shares with the subscriber (pairwise.hpp).
struct sender_proof {
  std::uint64_t number = 0;
  tag mac{};

  friend bool operator==(const sender_proof&, const sender_proof&) = default;
};

/// 0x16, up the tree: uint16 subscriber, uint8 number, uint16 producer, uint16 sequence, uint8 hops
/// made, uint8 1 if a proof of the sender follows, proof (16), value.
struct event {
  subscription_id id;
  mote_id producer;
  std::uint16_t sequence = 0; ///< of the producer; wraps
  std::uint8_t hops = 0;
  std::optional<sender_proof> proof;
  bytes value; ///< at most event_value_max

  friend bool operator==(const event&, const event&) = default;
};

/// 0x17, to all: uint16 sequence, uint8 1 if `of_last` is known, its time or 0, time now, uint16
/// root, uint16 round, uint8 hops to the root (255: the sender needs the time), uint16 digest of
/// the members, uint16 generation and uint16 maker of the best session keys.
struct sync_stamp {
  std::uint16_t sequence = 0;
  /// When the stamp with the number before this one's was on the air; nothing: unknown. Two steps:
  /// no octet need be changed while it is sent, which a MAC would not allow.
  std::optional<group_time> of_last;
  group_time now;          ///< when this one was handed to the radio: only as good as that
  mote_id root;            ///< whose clock it is
  std::uint16_t round = 0; ///< of the root: newer ones hold
  std::uint8_t hops = 0;   ///< 255: the sender has none to give
  std::uint16_t digest = 0;
  session_id best;

  friend bool operator==(const sync_stamp&, const sync_stamp&) = default;
};

/// 0x18, under older keys: a new pair. uint8 0, wrapped keys.
struct key_refresh {
  wrapped_keys keys;

  friend bool operator==(const key_refresh&, const key_refresh&) = default;
};

/// 0x19: are you speaking now? uint64 nonce.
struct challenge {
  std::uint64_t nonce = 0;

  friend bool operator==(const challenge&, const challenge&) = default;
};

/// 0x1a: I am. uint64 nonce of the challenge.
struct proof {
  std::uint64_t nonce = 0;

  friend bool operator==(const proof&, const proof&) = default;
};

using message = std::variant<discover, answer, join, join_challenge, join_proof, join_accept,
                             join_refuse, member_joined, member_left, member_list, subscribe,
                             unsubscribe, event, sync_stamp, key_refresh, challenge, proof>;

/// Whether such a message is sent under the network keys alone.
[[nodiscard]] bool is_network_level(const message& x);

/// "join_accept", ...
[[nodiscard]] std::string_view name_of(const message& x);

/// @pre texts and lists are within their limits
[[nodiscard]] bytes encode(const message& x);

/// Errors: truncated, too_long (octets after the message, a list or text above its limit),
/// bad_value (a flag or id that cannot be, text that is no printable ASCII), unsupported (unknown
/// kind).
[[nodiscard]] result<message> decode(byte_view octets);

} // namespace rubicon::smepp
