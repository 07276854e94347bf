// What is said of a group when it is created, looked for and found (D1.1 3.4.2, 3.4.3.1).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "smepp/crypto/key.hpp"
#include "smepp/group_id.hpp"

namespace rubicon::smepp {

/// When the members' radios are on for control messages: for `length` from each multiple of
/// `period` in the group's time (SMP-23). Both whole milliseconds below 65.536 s; 0: always.
struct management_cycle {
  duration period{};
  duration length = 100ms;

  friend bool operator==(const management_cycle&, const management_cycle&) = default;
};

struct group_description {
  /// 1..name_max printable ASCII characters.
  std::string name;
  /// masterKey: needed to enter if the group is closed, and to find it if it is private.
  std::optional<key> master = std::nullopt;
  bool is_closed = false;
  bool is_private = false;
  management_cycle management = {};

  static constexpr std::size_t name_max = 20;

  /// The name fits, the cycle is in range, and there is a key if, and only if, the group is closed
  /// or private: who has a key enters no group that others could have made without it.
  [[nodiscard]] bool is_valid() const;

  friend bool operator==(const group_description&, const group_description&) = default;
};

/// A description partially filled up: what is set has to match (SMP-06). Private groups are only
/// found with their key.
struct group_filter {
  std::optional<std::string> name = std::nullopt;
  std::optional<bool> is_closed = std::nullopt;
  std::optional<bool> is_private = std::nullopt;
  std::optional<key> master = std::nullopt;

  /// All but the key.
  [[nodiscard]] bool matches(const group_description& x) const;
};

/// 1..`max` characters from blank to `~`.
[[nodiscard]] bool is_name(std::string_view x, std::size_t max);

/// The id that `creator` gives a group of that name: 16 bits of a fold, never 0. The same name
/// elsewhere is another group.
[[nodiscard]] group_id id_of(std::string_view name, mote_id creator);

/// What opens the door to a group: its master key if it has one, else what every mote of the
/// network has. Who holds the credential may join; what is wrapped for members is wrapped with it.
/// Whoever has a master key never falls back to the network's, whatever others say of the group.
[[nodiscard]] key credential_of(const group_description& x, const key_pair& network);

/// All that both ends of a handshake have to agree on besides the key: name, flags, suite and
/// cycle.
[[nodiscard]] bytes terms_of(const group_description& x);

} // namespace rubicon::smepp
