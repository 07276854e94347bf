// The hosts that use a tuple space (TUP-10, TUP-19, P2P-09).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

inline constexpr std::size_t suspended_hosts_max = 64;

/// Who is known to the network, who uses the space before the network knows it, and what real
/// kernels that were given up had subscribed to. Knows neither links nor routes.
///
///   stranger --appear--> known --vanish--> suspended, if it may come back --appear--> known
class tuple_hosts {
public:
  struct known_host {
    bool marked = false; ///< of our kind: subscriptions to it have a lifetime and are refreshed
    std::int32_t incarnation = 0;
  };
  using known_hosts = std::map<peer_id, known_host>;

  /// @param strangers_max hosts that the network does not know
  /// @param stranger_age after so long without a message they are forgotten
  tuple_hosts(std::size_t strangers_max, duration stranger_age)
      : strangers_max_(strangers_max), stranger_age_(stranger_age) {}

  /// @param incarnation what of an unmarked host that vanishes is kept until it comes back with the
  ///        same number; 0: nothing is
  /// @returns what it had subscribed to when it vanished. A real kernel does not repeat it if it
  ///          has not given us up, too
  [[nodiscard]] std::vector<prototype> appear(peer_id host, bool marked, std::int32_t incarnation);

  /// @param subscribed what it had subscribed to here
  void vanish(peer_id host, std::vector<prototype> subscribed);

  /// May this host put something here? A kernel subscribes as soon as it receives our first
  /// package, before the network knows it: there are places for strangers.
  [[nodiscard]] bool admit(peer_id source, instant now);

  /// Forgets strangers that have been silent for too long. @returns them, ascending
  [[nodiscard]] std::vector<peer_id> take_silent(instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return next_silent_; } ///< of take_silent

  [[nodiscard]] const known_host* find(peer_id host) const; ///< null unless the network knows it
  [[nodiscard]] bool knows(peer_id host) const { return known_.contains(host); }
  [[nodiscard]] bool is_present(peer_id host) const { ///< known, or a stranger
    return known_.contains(host) || strangers_.contains(host);
  }
  [[nodiscard]] const known_hosts& known() const { return known_; }

  [[nodiscard]] std::uint64_t strangers_refused() const { return strangers_refused_; }
  [[nodiscard]] std::uint64_t suspended_forgotten() const { return suspended_forgotten_; }

private:
  struct suspended_host {
    std::int32_t incarnation = 0;
    std::vector<prototype> subscribed;
  };

  void suspend(peer_id host, std::vector<prototype> subscribed);

  std::size_t strangers_max_;
  duration stranger_age_;
  known_hosts known_;
  std::map<peer_id, instant> strangers_; ///< when the last message of each came
  std::map<peer_id, suspended_host> suspended_;
  std::optional<instant> next_silent_;
  std::uint64_t strangers_refused_ = 0;
  std::uint64_t suspended_forgotten_ = 0;
};

} // namespace rubicon::peis
