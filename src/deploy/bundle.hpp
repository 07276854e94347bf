// A TOML file with all that it names, in one piece: what travels to the hosts that run it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/load.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"

namespace rubicon::deploy {

/// Where a host is, in the place of what the file says.
struct host_place {
  std::string host;
  std::string address; ///< under which the others reach it, and at which it listens
  std::uint16_t control_port = 0;
  std::uint16_t peis_port = 0;
};
RUBICON_FIELDS(host_place, host, address, control_port, peis_port);

struct bundle {
  std::string name; ///< of the TOML file, as problems call it
  std::string toml;
  std::map<std::string, std::string> files; ///< content, by the path under which it is asked for
  std::map<std::string, std::vector<std::string>> folders; ///< names in them, likewise
  std::vector<host_place> places;                          ///< of hosts that are elsewhere
  std::vector<std::string> withheld; ///< names of the secrets that are zeros here, sorted
  std::uint64_t seed = 1;
  duration length{};
};
RUBICON_FIELDS(bundle, name, toml, files, folders, places, withheld, seed, length);

/// All files together, in octets.
inline constexpr std::size_t bundle_octets_max = std::size_t{256} << 20;

/// What is the same for all that was made of the same files, whatever its seed and length.
[[nodiscard]] std::string hash_of(const bundle& x);

struct packed {
  bundle what;           ///< complete only if there are no problems
  config::loaded loaded; ///< of it, with the seed of `instead`, if it has any, and in its mode
};

/// Reads a TOML file and what it names from the disk. Seed and length are the file's where
/// `instead` and `length` do not say otherwise.
[[nodiscard]] packed pack(const std::string& path, const config::overrides& instead,
                          std::optional<duration> length, const config::extensions& known);

/// The ecology of a bundle. What it names is nowhere but in the bundle.
/// @param instead its seed, if there is one, comes before the bundle's
[[nodiscard]] config::loaded load(const bundle& x, config::overrides instead,
                                  const config::extensions& known);

/// What a host is sent: of the secrets of the file those only that its part cannot be without.
/// @param what as pack() makes it
/// @param secrets that it has written
[[nodiscard]] bundle part_of(const bundle& what, const config::ecology_description& all,
                             const std::vector<config::secret_place>& secrets,
                             const std::string& host);

/// The same. @pre the file has no problems
[[nodiscard]] inline bundle part_of(const packed& x, const std::string& host) {
  return part_of(x.what, *x.loaded.ecology, x.loaded.seen.secrets, host);
}

/// Why a fault cannot happen to a part: it needs secrets that were not sent; empty: it can.
[[nodiscard]] std::string lacks(const bundle& part, const config::ecology_description& all,
                                const config::fault& x);

/// Lets hosts be where `places` says.
void place(config::ecology_description& out, const std::vector<host_place>& places);

inline constexpr const char* loopback = "127.0.0.1";

/// Puts all hosts on this computer, at ports that no other one has in the description, and
/// that are free on this computer as far as `is_free` says.
[[nodiscard]] std::vector<host_place>
places_on_one_computer(const config::ecology_description& all,
                       const std::function<bool(std::uint16_t port)>& is_free);

} // namespace rubicon::deploy
