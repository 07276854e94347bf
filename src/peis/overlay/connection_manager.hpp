// Which link to open or to close next (D1.1 3.1.6.4). Plain functions of what is known; p2p
// carries out what they decide.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/numbers/random.hpp"
#include "core/text/ipv4_network.hpp"
#include "core/time.hpp"
#include "peis/bluetooth/bluetooth.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Who connects to whom.
struct connection_config {
  /// Links to these addresses are always kept (AUT-01): `tcp://host:port`, `inproc://id`, ...
  std::vector<std::string> always;
  /// Where to ask for the others while there is no route to the peer that answers there (TCP-07).
  std::vector<std::string> seeds;
  /// Addresses that others send are tried in these only; empty: anywhere.
  std::vector<ipv4_network> networks;
  bool leaf = false;     ///< only links of `always` and within the host (LEA-01)
  bool manager = true;   ///< false: only links of `always` and `seeds` (CM-12)
  bool announces = true; ///< says every second on the group of announcements that we are there
  unsigned links_min = 3;
  unsigned links_suitable = 7;
  unsigned links_ceiling = 20; ///< without those of `always` and of cluster merges (CM-09)
  duration manager_period = 3s;
  duration cluster_period = 2s;
  duration announce_period = 1s;
  // Together below 5 s: what was cut off is back so soon after the mend.
  duration connect_timeout = 3s;
  duration always_retry = 500ms; ///< doubles while it fails, to always_retry_max
  duration always_retry_max = 1s;
  /// Who takes a link and closes it again at once, twice, is a leaf of another host or has no room:
  /// doubles each time, to refused_retry_max, for all such peers of one machine together (CM-10).
  duration refused_retry = 5s;
  duration refused_retry_max = 30s;
  double forced_octets_per_second = 2000; ///< to one host: a direct link is forced (CM-03)
};

/// A link that may be closed.
struct link_option {
  link_id link;
  /// By how much the metric to some host grows if the link is closed; unset: it must stay, because
  /// a host can be reached over it alone, because it is forced, or because it is young (CM-04).
  std::optional<unsigned> loss;
  unsigned connections = 0; ///< that its neighbour says it has
};

/// A host without link that can be tried now.
struct host_option {
  peer_id host;
  unsigned metric = 0;      ///< over the present route
  unsigned direct = 0;      ///< estimated, over a link of our own
  unsigned connections = 0; ///< that it says it has
};

struct open_link_to {
  peer_id host;
};
struct close_worst {
  link_id link;
};
using link_decision = std::variant<std::monostate, open_link_to, close_worst>;

/// V(h), CM-05: 100 x (metric - direct) + a random number 0..99.
/// Deviation: minus 100 for every connection above `links_min` that the host has, as real kernels
/// do (docs/peis-wire.md 14); else full hosts are asked again and again and close others instead.
[[nodiscard]] int value_of(const host_option& x, const connection_config& config,
                           random_stream& rng);

/// V(c), CM-04, comparable with V(h). @pre x.loss
[[nodiscard]] int value_of(const link_option& x);

/// CM-06 to CM-08 (docs/peis-wire.md 14). @param links all but those of `always`, closable or not
[[nodiscard]] link_decision decide(std::span<const link_option> links,
                                   std::span<const host_option> hosts,
                                   const connection_config& config, random_stream& rng);

/// The closable link of least value; of equal ones that whose neighbour misses it least.
[[nodiscard]] std::optional<link_option> worst_of(std::span<const link_option> links);

/// Whether a connect request may be accepted (CM-09, docs/peis-wire.md 3.2), and what for.
enum class admission : std::uint8_t { accept, replace_worst, refuse };
[[nodiscard]] admission admit(std::uint32_t request_flags, std::span<const link_option> links,
                              const connection_config& config);

/// Addresses in `other` that `self` can connect to: loopback ones for peers of one machine, other
/// ones only if `self` has such an address too, in-process ones for peers of one process. Those of
/// UDP only if `self` has one of them as well (UDP-01). Bluetooth ones, slow as they are, only if
/// there are no others and what is `near` is connectable (BT-06).
[[nodiscard]] std::vector<std::string>
connectable_urls(const host_record& self, const host_record& other, const bluetooth& near = {});

} // namespace rubicon::peis
