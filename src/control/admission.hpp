// Which unauthenticated connections may stay open.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "core/text/ipv4_network.hpp"
#include "core/time.hpp"

namespace rubicon::control {

struct admission_limits {
  std::size_t all_max = 64;
  std::size_t of_address_max = 16;
  std::uint32_t per_second = 25; ///< from one address, on average
  std::uint32_t at_once = 100;   ///< from one address
};

/// A new connection is admitted. At the limit it replaces the oldest of the address that has the
/// most: an address with many connections displaces only its own.
class admission {
public:
  using id = std::uint64_t;

  explicit admission(admission_limits limits = {}) : limits_(limits) {}

  struct decision {
    bool enters = false; ///< false: its address connects too often; close it at once
    std::optional<id> leaves;
  };

  /// @param who unique number
  [[nodiscard]] decision arrive(id who, const ipv4_address& from, instant now);

  /// The connection has authenticated, or is closed. Harmless for others.
  void leave(id who);

  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

private:
  struct waiter {
    id who = 0;
    ipv4_address from{};
  };

  /// What an address may still do at `at`.
  struct ration {
    duration used{}; ///< of the time that its connections stand for
    instant at;
  };

  static constexpr std::size_t rations_max = 1024;

  [[nodiscard]] bool comes_too_often(const ipv4_address& from, instant now);
  [[nodiscard]] std::size_t count(const ipv4_address& from) const;
  [[nodiscard]] ipv4_address most_numerous() const;
  [[nodiscard]] id remove_oldest(const ipv4_address& from);

  admission_limits limits_;
  std::deque<waiter> waiting_; ///< the oldest first
  std::map<ipv4_address, ration> rations_;
};

} // namespace rubicon::control
