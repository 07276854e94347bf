// Proof of routes that may lead in circles: hosts that are to give a sign of life in time.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// A trace is to be sent to this host.
struct probe_host {
  peer_id host;
  std::size_t attempt; ///< from 0
};

/// It gave no sign of life: the route to it leads nowhere.
struct way_disproved {
  peer_id host;
  instant since; ///< the first trace
};

class route_probes {
public:
  using output = std::variant<probe_host, way_disproved>;
  using outputs = std::vector<output>;

  route_probes() = default;
  /// @param hosts_max at a time; the routes to others are believed
  route_probes(std::size_t hosts_max, duration timeout)
      : hosts_max_(hosts_max), timeout_(timeout) {}

  void begin(peer_id host, instant now);  ///< unless it is being probed
  void extend(peer_id host, instant now); ///< the same; if it is, it has its whole time from now on

  /// It lives, or is of no interest any more.
  void end(peer_id host) { probes_.erase(host); }

  /// All that are to be probed again, then all that were silent; harmless before deadline().
  [[nodiscard]] outputs on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return next_; }

private:
  struct probe {
    instant since;
    instant deadline;
    instant next; ///< try
    std::size_t attempts = 0;
  };

  std::size_t hosts_max_ = 0;
  duration timeout_{};
  std::map<peer_id, probe> probes_;
  std::optional<instant> next_;
};

} // namespace rubicon::peis
