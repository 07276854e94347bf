// A running ecology at one moment, as `rubicon top` shows it: peers, gateways with their motes,
// proxies with their values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "peis/tuples/tuple.hpp"

namespace rubicon::cli {

struct top_peer {
  peer_id id;
  std::string name;               ///< as it calls itself; empty: it has not
  std::optional<unsigned> metric; ///< cost of the route to it; unset: there is none
  std::optional<unsigned> links;  ///< that it has; unset: it has not said
  std::uint64_t tuples = 0;       ///< without kernel.*
  double changes_per_s = 0;
};

struct top_gateway {
  peer_id id;
  std::string name;
  std::string line; ///< the first word of `devices.line`: `up`, `silent`; empty: not known
  std::string role; ///< of `devices.role`: `leads`, `stands_by`; empty: it is its island's only one
  std::vector<std::uint32_t> motes; ///< that it lists
  std::uint64_t stale = 0;          ///< of them, those whose sink is silent
  std::uint64_t left = 0;           ///< motes that have left
  double changes_per_s = 0;
};

struct top_proxy {
  peer_id owner;
  std::string prefix;
  std::string mote;                                        ///< `kitchen/7`, or `rfid/e0040101`
  std::string status;                                      ///< and why, if it says so
  std::vector<std::pair<std::string, std::string>> values; ///< by name, with their units
  double changes_per_s = 0;
};

/// Each list by activity, the liveliest first; of nearly equal ones by id or prefix.
struct top_picture {
  std::string network;
  std::string via;  ///< the peer by which it is seen, as a URL
  std::string time; ///< of day
  std::vector<top_peer> peers;
  std::vector<top_gateway> gateways;
  std::vector<top_proxy> proxies;
  std::uint64_t tuples = 0;
  double changes_per_s = 0;
};

/// What is known of a peer without its tuples.
struct top_host {
  std::string name;
  std::optional<unsigned> metric;
  std::optional<unsigned> links;
};

/// Counts changes between pictures. Rates are those of about the last five seconds, so that rows do
/// not change places all the time. Tuples of kernel.* are no changes: peers publish them because
/// somebody looks.
class top_observer {
public:
  static constexpr duration remembered = 5s;
  static constexpr std::size_t keys_max = 100'000; ///< counted apart between two pictures

  void on_change(const peis::tuple& x);

  /// @param tuples all there are
  /// @param gone real time since the picture before, or since the first change could be received
  [[nodiscard]] top_picture look(const std::map<peer_id, top_host>& hosts,
                                 const std::vector<peis::tuple_pointer>& tuples, duration gone);

  /// Forgets what was counted: it was there before.
  void restart() { changes_.clear(); }

private:
  using name = std::pair<peer_id, std::string>;
  class rates;

  std::map<name, std::uint64_t> changes_; ///< by owner and folded key
  std::map<name, double> rates_;          ///< of the rows of the last picture, by what is counted
};

/// @param height lines that there may be; unset: any number
[[nodiscard]] std::string top_text(const top_picture& x, std::size_t width,
                                   std::optional<std::size_t> height, bool colour);

/// One JSON object on one line.
[[nodiscard]] std::string top_json(const top_picture& x);

} // namespace rubicon::cli
