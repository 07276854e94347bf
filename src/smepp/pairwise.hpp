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
/// key that only the deployment knows, and put into the two motes, nobody else can.
[[nodiscard]] key pairwise_key(const key& root, mote_id a, mote_id b);

/// What one peer shares with each of the others, if a group's events are to prove their sender
/// (`authenticate = "sender"`). A proof costs 8 octets an event, and a MAC at either end.
class pairwise_keys {
public:
  explicit pairwise_keys(std::size_t capacity = 16) : capacity_(capacity) {}

  /// @returns false if there is no room
  bool set(mote_id other, const key& x);

  /// The proof of an event for its subscriber; nothing without a key for the other one.
  [[nodiscard]] std::optional<tag> prove(const event& x, group_id group) const;

  /// At the subscriber: whether the proof is there and right.
  [[nodiscard]] bool is_proven(const event& x, group_id group) const;

  [[nodiscard]] std::size_t footprint() const { return keys_.size() * (2 + key::size); }

private:
  std::size_t capacity_;
  std::map<mote_id, key> keys_;
};

} // namespace rubicon::smepp
