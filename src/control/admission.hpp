// Which of those who have connected, and have not said who they are, may stay.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "core/ipv4_network.hpp"
#include "core/time.hpp"

namespace rubicon::control {

struct admission_limits {
  std::size_t all_max = 64;
  std::size_t of_address_max = 16;
  std::uint32_t per_second = 25; ///< from one address, on average
  std::uint32_t at_once = 100;   ///< from one address
};

/// Whoever comes gets in, in the place of the one that has waited longest of the address that has
/// the most: who holds many connections only pushes out its own.
class admission {
public:
  using id = std::uint64_t;

  explicit admission(admission_limits limits = {}) : limits_(limits) {}

  struct decision {
    bool enters = false; ///< if not, it comes too often and is to be closed at once
    std::optional<id> leaves;
  };

  /// @param who no other has the number
  [[nodiscard]] decision arrive(id who, const ipv4_address& from, instant now);

  /// It has said who it is, or is gone. Harmless for others.
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
  std::deque<waiter> waiting_; ///< who has waited longest first
  std::map<ipv4_address, ration> rations_;
};

} // namespace rubicon::control
