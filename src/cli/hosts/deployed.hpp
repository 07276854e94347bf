// What this user has deployed last, so that `rubicon status`, `stop` and `fault` find it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/plan/ecology.hpp"
#include "control/tls.hpp"
#include "core/text/name.hpp"

namespace rubicon::cli {

struct deployed_host {
  std::string name;
  std::string address;
  std::uint16_t port = 0;      ///< of `rubicon host`
  std::uint16_t peis_port = 0; ///< of its PEIS links; written, but not read, too

  /// That its certificate must have; empty: any, for it is called by its address.
  [[nodiscard]] std::string certificate_name() const { return is_name(name) ? name : ""; }
};

/// Those that run something, in the order of the file.
[[nodiscard]] std::vector<deployed_host> hosts_of(const config::ecology_description& all);

struct deployed {
  std::string id;      ///< of the deployment
  std::string ecology; ///< its name
  std::string file;    ///< the TOML file's path
  std::vector<deployed_host> hosts;
  control::tls_files tls;   ///< of the coordinator
  std::string network = {}; ///< PEIS network; written, so that commands find it, but not read
};

/// Replaces what was remembered of the same ecology. @returns empty, or why it is not stored
[[nodiscard]] std::string remember(const deployed& x);

/// Nobody follows it any more.
void forget(const deployed& x);

/// @param ecology its name; empty: the one that was deployed last
[[nodiscard]] std::optional<deployed> remembered(const std::string& ecology);

} // namespace rubicon::cli
