// The simulated network between the hosts of peers: who can be reached, which links are open, and
// what goes wrong. Octets of links do not pass through here: see peis/media/simulated_link.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "peis/media/simulated_media.hpp"

namespace rubicon::peis {

/// A datagram for all that receive announcements arrives.
struct announcement_heard {
  station_id station;
  payload octets;
};

/// The condition of an open link is another from now on.
struct condition_set {
  station_id station;
  link_id link;
  link_condition condition;
};

/// Peers of two different groups do not receive each other's packets; those in none are a group.
/// Between any two of `lossy`, or between all if it is empty, packages are lost.
struct lan_fault {
  std::vector<std::vector<peer_id>> groups; ///< empty: no partition
  double loss = 0;                          ///< 0..1; those of several faults add up
  std::vector<peer_id> lossy;
};

/// What it sends takes the network's delay, but for condition_set, which is no message.
class simulated_lan {
public:
  using output =
      std::variant<link_made, link_refused, link_reset, announcement_heard, condition_set>;
  using outputs = std::vector<output>;

  simulated_lan() = default;
  /// @param loss of packages and announcements, 0..1, each link and way alike
  simulated_lan(double loss, random_stream rng) : loss_(loss), rng_(rng) {}

  /// A process has started: others reach it by its id from now on.
  /// @param hears announcements
  void join(station_id station, peer_id id, bool hears);

  /// The process has ended. Its links are reset, as soon as its computer can send.
  [[nodiscard]] outputs end(station_id station);

  /// Asks for a link to that peer: of two processes with one id to the older, never to itself.
  /// Nothing comes of it if the network carries nothing between them.
  [[nodiscard]] outputs connect(station_id station, attempt_id attempt, peer_id to);

  /// For all others that receive announcements.
  /// In a large network one that has not changed arrives once in repeat_after.
  [[nodiscard]] outputs announce(station_id station, const payload& octets, instant now);

  /// One end has closed a link, and notifies the other end itself.
  void end_link(link_id link) { links_.erase(link); }

  /// A computer without power says nothing, not even that a process has ended.
  [[nodiscard]] outputs set_power(station_id station, bool on);

  /// @param name of the fault, chosen by the caller
  [[nodiscard]] outputs begin_fault(std::uint64_t name, const lan_fault& x);
  [[nodiscard]] outputs end_fault(std::uint64_t name);

private:
  /// It stays here after its end as long as a station has a link to it.
  struct process {
    peer_id id;
    bool hears = true;
    bool runs = true;
    bool powered = true;
    payload announced{};               ///< last
    std::string computer{};            ///< by that
    instant since{};                   ///< when the first of those below received it
    std::vector<station_id> reached{}; ///< who has it, ascending
  };
  struct connection {
    station_id initiator;
    station_id acceptor;
    link_condition condition; ///< as the ends have been notified
  };
  struct fault {
    std::map<peer_id, std::size_t> groups; ///< empty: no partition
    double loss = 0;
    std::set<peer_id> lossy; ///< empty: all
  };

  [[nodiscard]] static bool separates(const fault& x, peer_id a, peer_id b);
  [[nodiscard]] link_condition condition_between(const process& a, const process& b) const;
  [[nodiscard]] bool can_refuse(const process& from, peer_id id) const;
  [[nodiscard]] bool settle(link_id number, connection& x, outputs& out) const;
  [[nodiscard]] outputs settle_links();
  void forget_announcements();
  void note_announced(process& from, const payload& octets, instant now) const;

  double loss_ = 0;
  random_stream rng_;
  std::map<station_id, process> stations_;
  std::map<link_id, connection> links_;
  std::map<std::uint64_t, fault> faults_;
  std::uint64_t next_link_ = 1;
};

} // namespace rubicon::peis
