// Commands that look into a running PEIS network from outside (SVC-07, SVC-08).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::cli {

/// How to get into the network.
struct network_options {
  std::string peer;                ///< `tcp://host:port`
  std::string network = "rubicon"; ///< as the ecology's default is
  std::optional<peer_id> id;       ///< ours; unset: a high one by chance
  duration timeout = 5s;           ///< of each wait
  bool json = false;
};

/// `rubicon tuples get KEY`
struct get_tuple {
  std::string key;
  std::optional<peer_id> owner; ///< unset: everybody who has one
};

/// `rubicon tuples set KEY VALUE` and `rubicon tuples append KEY VALUE`
struct write_tuple {
  peer_id owner;
  std::string key;
  std::string value;
  bool append = false;
  bool wait = false; ///< until its proxy has told how it ended; not of `append`
};

/// `rubicon tuples delete KEY`
struct delete_tuple {
  peer_id owner;
  std::string key;
};

/// `rubicon tuples meta KEY [TARGET]`
struct meta_tuple {
  peer_id owner;
  std::string key;
  std::optional<std::string> target;   ///< unset: show where it points; the next two are unset then
  std::optional<peer_id> target_owner; ///< unset: `owner`
  bool nowhere = false;                ///< instead of a target
};

/// `rubicon tuples ls [PATTERN]`
struct list_tuples {
  std::string pattern; ///< empty: all but kernel.*, unless `all`
  std::optional<peer_id> owner;
  bool all = false;
};

/// `rubicon tuples watch PATTERN...`
struct watch_tuples {
  std::vector<std::string> patterns;
  std::optional<peer_id> owner;
  std::optional<duration> length;     ///< unset: until interrupted
  std::optional<std::uint64_t> count; ///< of changes
};

/// `rubicon hosts`
struct list_hosts {};

/// `rubicon route ID`
struct trace_route {
  peer_id host;
};

/// `rubicon ping ID`
struct ping_host {
  peer_id host;
  std::uint64_t count = 4;
};

struct network_command {
  network_options with;
  std::variant<get_tuple, write_tuple, delete_tuple, meta_tuple, list_tuples, watch_tuples,
               list_hosts, trace_route, ping_host>
      what;
};

} // namespace rubicon::cli
