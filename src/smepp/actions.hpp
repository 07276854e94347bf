// What the parts of SMEPP Light request of their owner, the peer, and the signals that they send to
// the application, with the names of D1.1 table 1.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "smepp/messages.hpp"

namespace rubicon::smepp {

// ---- signals for the application, with the names of D1.1 table 1
// NOLINTBEGIN(readability-identifier-naming)

/// The groups found, once the time for answers is over; more about each: smepp_getGroupDescription.
struct getGroups_result {
  std::vector<group_id> groups;

  friend bool operator==(const getGroups_result&, const getGroups_result&) = default;
};

/// A subscription as the application sees it.
struct subscription_info {
  subscription_id id;
  std::string name;
  std::optional<instant> expires; ///< on our own clock; nothing: never
  duration interval{};            ///< 1 / rate; 0: no rate
  instant offset;                 ///< when it was made, on our own clock: for alignment (SMP-16)

  friend bool operator==(const subscription_info&, const subscription_info&) = default;
};

/// Joined, with what is subscribed there; or not, and why.
struct joinGroup_result {
  group_id group;
  std::vector<subscription_info> subscriptions;
  std::optional<failure> error; ///< nothing: success

  friend bool operator==(const joinGroup_result&, const joinGroup_result&) = default;
};

struct peerJoined {
  group_id group;
  peer_description peer;

  friend bool operator==(const peerJoined&, const peerJoined&) = default;
};

/// Our own id: smepp_leaveGroup is complete.
struct peerLeft {
  mote_id peer;
  group_id group;

  friend bool operator==(const peerLeft&, const peerLeft&) = default;
};

struct subscribed {
  group_id group;
  subscription_info what;

  friend bool operator==(const subscribed&, const subscribed&) = default;
};

/// It was withdrawn, has expired, or its subscriber has sent no refresh for long.
struct unsubscribed {
  group_id group;
  subscription_id id;
  std::string name;

  friend bool operator==(const unsubscribed&, const unsubscribed&) = default;
};

struct receive_result {
  mote_id sender; ///< as the group's keys prove it: a member says so; see is_sender_proven
  group_id group;
  std::string name;
  bytes value;
  bool is_sender_proven = false; ///< by a pairwise key

  friend bool operator==(const receive_result&, const receive_result&) = default;
};

// NOLINTEND(readability-identifier-naming)

using signal = std::variant<getGroups_result, joinGroup_result, peerJoined, peerLeft, subscribed,
                            unsubscribed, receive_result>;

// ---- requests to the peer

/// When a message may leave: at once; when the group's members are awake for control messages; or
/// when they are for this subscription, or the former.
enum class slot : std::uint8_t { at_once, management, subscription };

/// In a token: the step of a handshake, for the group in its low half.
inline constexpr std::uint64_t step_token = std::uint64_t{1} << 63;

/// Seal this and hand it to the radio.
struct to_send {
  mote_id to;     ///< a neighbour or broadcast_mote
  group_id group; ///< whose windows count; at network level too
  message content;
  slot when = slot::management;
  subscription_id subscription = {};              ///< with slot::subscription
  std::optional<session_id> under = std::nullopt; ///< nothing: the group's keys for sending
  unsigned copies = 1;                            ///< of a broadcast, spread
  duration delay = {};                            ///< at least
  std::uint64_t token = 0;                        ///< not 0: its sender receives the outcome
  provenance from = {};                           ///< of what is sent
  std::optional<key> bound_under = std::nullopt;  ///< of a join_accept, whose MAC is made last
};

/// The keys of a group have changed, or it has come or gone: security and store must know.
struct keys_changed {
  group_id group;
};

/// Forget what waits to be sent in that group.
struct group_gone {
  group_id group;
};

/// A peer was let in, or a member has caught up: it needs the subscriptions, under these keys.
struct newcomer {
  group_id group;
  mote_id peer;
  session_id session;
};

using action = std::variant<to_send, keys_changed, group_gone, newcomer, signal>;
using actions = std::vector<action>;

} // namespace rubicon::smepp
