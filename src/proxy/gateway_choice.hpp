// Which of an island's gateways a proxy manager listens to (GW-14, PXY-14).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"

namespace rubicon::proxy {

/// Follows the tuples of all gateways of one island, and hands on those of the one that leads, as
/// if there were no other. When another one takes the lead, what it knows is handed on again; the
/// manager finds its motes there as they were, and their proxies live on.
///
/// With one gateway every tuple is handed on.
class gateway_choice {
public:
  struct tuple_change {
    std::string key;
    bytes value;
    bool deleted = false; ///< the gateway has gone, and no other is there; `value` is empty
  };

  gateway_choice() = default;
  /// @pre at least one, the one that is listened to at first in front
  explicit gateway_choice(std::vector<peer_id> gateways) : gateways_(std::move(gateways)) {}

  /// A tuple of one of the gateways has a new value. @returns what is handed on to the manager
  [[nodiscard]] std::vector<tuple_change> on_tuple(peer_id from, std::string_view key,
                                                   byte_view value);

  /// The list of motes of one of the gateways is there no more.
  [[nodiscard]] std::vector<tuple_change> on_list_deleted(peer_id from);

  [[nodiscard]] const std::vector<peer_id>& gateways() const { return gateways_; }
  [[nodiscard]] peer_id current() const { return gateways_.at(current_); }
  [[nodiscard]] std::uint64_t refused() const { return refused_; } ///< no room: not remembered

  static constexpr std::size_t tuples_max = 200'000; ///< remembered of one gateway

private:
  using tuples = std::map<std::string, bytes, std::less<>>;

  [[nodiscard]] std::vector<tuple_change> take_lead(std::size_t gateway);

  std::vector<peer_id> gateways_;
  std::size_t current_ = 0;
  std::map<peer_id, tuples> known_; ///< of several gateways: the newest values
  std::uint64_t refused_ = 0;
};

} // namespace rubicon::proxy
