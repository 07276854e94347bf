// How much of what the tuple space sends others may be in flight: to one host and to all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "core/time.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

struct push_window_config {
  std::size_t messages_max = 2048;                ///< to one host
  std::size_t octets_max = std::size_t{1} << 20U; ///< to one host, beyond the first message
  std::size_t total_max = std::size_t{16} << 20U; ///< octets to all hosts
  /// Octets of a message that may be the only one in flight to a host even beyond total_max.
  std::size_t small = std::size_t{64} << 10U;
};

/// A host that does not acknowledge gets one message at a time, until it does: then its window
/// doubles with each. So a host that never reads cannot hold what others wait for.
class push_window {
public:
  /// What a message was about.
  struct ticket {
    peer_id host;
    std::size_t octets = 0;
    std::optional<std::uint64_t> question; ///< a subscription of ours; else a value or deletion
    std::optional<instant> failing_since;  ///< of one that has failed before
  };

  push_window() = default;
  explicit push_window(push_window_config config) : config_(config) {}

  /// May a message of this size leave?
  [[nodiscard]] bool admits(peer_id host, std::size_t octets) const;
  /// Is nothing in flight to it? What is not admitted then waits for room for all.
  [[nodiscard]] bool idle(peer_id host) const {
    const auto at = hosts_.find(host);
    return at == hosts_.end() || at->second.requests.empty();
  }

  /// It leaves. @returns what it is to be sent under
  [[nodiscard]] request_id leave(ticket x);

  /// It was acknowledged, or was not. @returns nothing for requests of others
  std::optional<ticket> finish(request_id request, bool acknowledged);

  /// Forgets a host.
  void drop(peer_id host);

  [[nodiscard]] std::size_t octets() const { return total_; }
  [[nodiscard]] std::size_t messages() const { return in_flight_.size(); }

private:
  struct flow {
    std::size_t window = 0; ///< messages
    std::size_t octets = 0;
    std::set<request_id> requests; ///< in flight
  };

  push_window_config config_;
  std::map<peer_id, flow> hosts_;
  std::map<request_id, ticket> in_flight_;
  std::size_t total_ = 0;
  std::uint64_t made_ = 0;
};

} // namespace rubicon::peis
