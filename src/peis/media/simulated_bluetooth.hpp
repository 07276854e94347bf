// Simulated Bluetooth between the machines of peers (BT-02): which adapters and devices are
// where, who announces on an adapter, which links are open. Octets of links do not pass through
// here: see peis/media/simulated_link.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "peis/media/simulated_media.hpp"
#include "peis/overlay/p2p_events.hpp"

namespace rubicon::peis {

struct bluetooth_medium {
  double range_m = 0;
  double reference_db = 0; ///< loss at the first metre
  double exponent = 0;     ///< of the distance
  bool takeover = false;   ///< another announces when the one that does has ended (BT-03)
};

/// The n-th port of a machine where links are taken; as L2CAP asks for, the low octet is odd and
/// the high one even.
[[nodiscard]] std::uint16_t bluetooth_port(std::size_t n);

/// Each adapter of a machine has an address of its own, made up of the two names.
[[nodiscard]] bluetooth_address address_of_adapter(const std::string& machine,
                                                   const std::string& adapter);

/// What a scan has found: all that are in range, ascending by address.
struct devices_seen {
  station_id station;
  std::string adapter; ///< of the station
  std::vector<seen_device> devices;
};

/// A HELLO has come to an adapter that the station has opened.
struct hello_heard {
  station_id station;
  station_id from;
  say_hello question; ///< as given
};

/// No station answers.
struct hello_unheard {
  station_id station;
  say_hello question; ///< as given
};

/// Links over Bluetooth have numbers from here on, below those of real ones.
inline constexpr std::uint64_t first_bluetooth_link = std::uint64_t{1} << 62;

/// A machine's adapters are shared by the processes that open them: the first one announces all of
/// them, and who can be heard and is announced answers HELLOs and takes links. What this tells
/// takes the network's delay.
class simulated_bluetooth {
public:
  using output =
      std::variant<link_made, link_refused, link_reset, devices_seen, hello_heard, hello_unheard>;
  using outputs = std::vector<output>;

  simulated_bluetooth() = default;
  explicit simulated_bluetooth(bluetooth_medium x) : medium_(x) {}

  /// Something that has Bluetooth and is no peer.
  void add_device(const bluetooth_address& address, position place);

  /// A process has started, and opens adapters of its machine. They stay where they are if others
  /// have opened them before.
  /// @param port where it takes links
  void join(station_id station, const std::string& machine,
            const std::vector<std::string>& adapters, position place, std::uint16_t port);

  /// The process has ended, and its links with it. The right to announce goes too, unless takeover
  /// says otherwise.
  [[nodiscard]] outputs end(station_id station);

  [[nodiscard]] outputs scan(station_id station, const std::string& adapter) const;

  /// All that share the adapter asked for are notified, if one of them announces.
  [[nodiscard]] outputs hello(station_id station, const say_hello& question) const;

  /// Asks for a link to who takes them at that port of an adapter.
  [[nodiscard]] outputs connect(station_id station, attempt_id attempt, const bluetooth_address& to,
                                std::uint16_t port);

  /// One end has closed a link, and notifies the other end itself.
  void end_link(link_id link) { links_.erase(link); }

  [[nodiscard]] outputs set_power(station_id station, bool on);

  /// A machine, with all its adapters, is somewhere else from now on.
  [[nodiscard]] outputs move(const std::string& machine, position place);

private:
  /// An adapter of a machine, or a device that is no peer.
  struct adapter {
    std::string machine; ///< empty: none of a peer
    position place;
    std::vector<station_id> stations;    ///< that have opened it, in that order
    std::optional<station_id> announcer; ///< of them: it alone makes all of them known (BT-03)
    std::set<station_id> dark;           ///< stations whose power has gone
  };
  struct process {
    std::map<std::string, bluetooth_address> adapters; ///< by name
    std::uint16_t port = 0;
  };
  struct connection {
    station_id initiator;
    station_id acceptor;
    bluetooth_address from; ///< adapters
    bluetooth_address to;
  };

  [[nodiscard]] bool hear(const adapter& a, const adapter& b) const;
  [[nodiscard]] int strength_dbm(const adapter& a, const adapter& b) const;
  [[nodiscard]] const adapter* adapter_of(station_id station, const std::string& name) const;
  [[nodiscard]] const adapter* announced(const adapter& from,
                                         const bluetooth_address& address) const;
  [[nodiscard]] std::optional<station_id> listener(const adapter& at, std::uint16_t port) const;
  [[nodiscard]] outputs settle_links();

  bluetooth_medium medium_;
  std::map<bluetooth_address, adapter> adapters_;
  std::map<station_id, process> stations_; ///< that run
  std::map<link_id, connection> links_;
  std::uint64_t next_link_ = first_bluetooth_link;
};

} // namespace rubicon::peis
