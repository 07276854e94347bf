// Who said it, not only that a member did: keys that two peers alone share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "core/address.hpp"
#include "smepp/messages.hpp"

namespace rubicon::smepp {

/// The key of two peers, whichever is named first. It is worth what the secrecy of `root` is: drawn
/// from a master or network key, which all members have, any of them can compute it; drawn from a
/// key that only the deployment knows, and put into the two motes, no other can.
[[nodiscard]] key pairwise_key(const key& root, mote_id a, mote_id b);

/// What one peer shares with each of the others, if a group's events are to prove their sender
/// (`authenticate = "sender"`). A proof costs 16 octets an event, and a MAC at either end. It holds
/// for one event of one subscription: the producer uses no number twice, and the subscriber takes
/// none twice.
class pairwise_keys {
public:
  explicit pairwise_keys(std::size_t capacity = 16) : capacity_(capacity) {}

  /// @returns false if there is no room
  bool set(mote_id other, const key& x);

  [[nodiscard]] bool has(mote_id other) const { return keys_.contains(other); }

  /// The proof of an event for its subscriber; nothing without a key for the other one.
  /// @param number not used before
  [[nodiscard]] std::optional<sender_proof> prove(const event& x, group_id group,
                                                  group_time made_at, std::uint64_t number) const;

  /// At the subscriber: whether the proof is there and right. Changes nothing.
  /// @param made_at of the subscription: what was raised for one of a former life is not for this
  [[nodiscard]] bool is_proven(const event& x, group_id group, group_time made_at) const;

  /// @returns whether it has not been taken before, and takes it. @pre is_proven()
  [[nodiscard]] bool take(const event& x);

  [[nodiscard]] std::size_t footprint() const { return keys_.size() * (2 + key::size + 8 + 4); }

private:
  struct shared_key {
    key under;
    std::uint64_t highest = 0; ///< of the numbers taken
    std::uint32_t seen = 0;    ///< bit i: highest - i
  };

  std::size_t capacity_;
  std::map<mote_id, shared_key> keys_;
};

} // namespace rubicon::smepp
