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

/// How to join the network.
struct network_options {
  std::string peer;                ///< `tcp://host:port`; empty: what is found
  std::string network = "rubicon"; ///< as the ecology's default is
  bool network_given = false;      ///< joins no other
  bool lan = false;                ///< looks on the local network too, with `peer` empty
  std::optional<peer_id> id;       ///< ours; unset: a high one by chance
  duration timeout = 5s;           ///< of each wait
  bool json = false;
  std::vector<std::string> without_effect = {}; ///< `--peis-net-metric`, for a warning
};

/// A peer by its id or its name; by neither: whichever fits alone.
struct peer_selector {
  std::optional<peer_id> id;
  std::string name; ///< `care-pc`, or with its host and process as `rubicon hosts` shows it

  [[nodiscard]] bool is_any() const { return !id && name.empty(); }
};

/// `rubicon tuples get KEY`
struct get_tuple {
  std::string key;
  peer_selector owner; ///< any: everybody who has one
};

/// `rubicon tuples set KEY VALUE` and `rubicon tuples append KEY VALUE`
struct write_tuple {
  peer_selector owner; ///< any: the one who has it
  std::string key;
  std::string value;
  bool append = false;
  bool wait = false; ///< until its proxy has reported how it ended; not of `append`
};

/// `rubicon tuples delete KEY`
struct delete_tuple {
  peer_selector owner; ///< any: the one who has it
  std::string key;
};

/// `rubicon tuples meta KEY [TARGET]`
struct meta_tuple {
  peer_selector owner; ///< any: the one who has it
  std::string key;
  std::optional<std::string> target; ///< unset: show where it points; the next two are unset then
  peer_selector target_owner;        ///< any: `owner`
  bool nowhere = false;              ///< instead of a target
};

/// `rubicon tuples ls [PATTERN]`
struct list_tuples {
  std::string pattern; ///< empty: all but kernel.*, unless `all`
  peer_selector owner;
  bool all = false;
};

/// `rubicon tuples watch PATTERN...`
struct watch_tuples {
  std::vector<std::string> patterns;
  peer_selector owner;
  std::optional<duration> length;     ///< unset: until interrupted
  std::optional<std::uint64_t> count; ///< of changes
};

/// `rubicon tuples graph`
struct show_graph {
  bool dot = false; ///< for Graphviz
  bool all = false; ///< also kernel.* and who looks at them
};

/// `rubicon top`
struct show_top {
  bool once = false;                  ///< one picture, as text
  duration every = 1s;                ///< between two
  std::optional<std::uint64_t> count; ///< of pictures; unset: until it is ended
};

/// `rubicon hosts`
struct list_hosts {};

/// `rubicon route ID`
struct trace_route {
  peer_selector host; ///< not any
};

/// `rubicon ping ID`
struct ping_host {
  peer_selector host; ///< not any
  std::uint64_t count = 4;
};

struct network_command {
  network_options with;
  std::variant<get_tuple, write_tuple, delete_tuple, meta_tuple, list_tuples, watch_tuples,
               show_graph, show_top, list_hosts, trace_route, ping_host>
      what;
};

} // namespace rubicon::cli
