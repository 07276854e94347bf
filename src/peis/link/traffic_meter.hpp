// How much goes to each host: what a direct link is opened for, and kept (CM-02, CM-03).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "core/time.hpp"
#include "peis/link/outgoing_queue.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Octets a second to each destination, smoothed over the runs of measure().
class traffic_meter {
public:
  traffic_meter() = default;
  /// @param hosts_max further ones are not measured
  traffic_meter(std::size_t hosts_max, instant now) : hosts_max_(hosts_max), measured_(now) {}

  /// What goes to one peer, from all senders, without the network's own services (CM-02).
  void count(const outgoing_package& x);

  /// To be called now and then, with what has been counted since.
  void measure(instant now);

  [[nodiscard]] double octets_per_second(peer_id to) const;

  /// Hosts to which more than so many octets a second go, ascending.
  [[nodiscard]] std::vector<peer_id> above(double octets_per_second) const;

  void forget(peer_id host) { hosts_.erase(host); }

private:
  struct traffic {
    std::uint64_t octets = 0; ///< since the last measure()
    double per_second = 0;
  };

  std::size_t hosts_max_ = 0;
  instant measured_;
  std::map<peer_id, traffic> hosts_;
};

} // namespace rubicon::peis
