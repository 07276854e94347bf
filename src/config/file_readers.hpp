// Reads the tables of a file. Each function describes one kind of table; load.cpp calls them.
#pragma once

#include <vector>

#include "config/claims.hpp"
#include "config/directory.hpp"
#include "config/ecology.hpp"
#include "config/mote_readers.hpp"
#include "config/table_reader.hpp"

namespace rubicon::config {

/// What the readers of islands and peers need from the tables before them, and must not share.
struct surroundings {
  reading& shared;
  const directory& names;
  double range_m = 0;
  mote_types types;
  std::set<std::string> types_used;
  name_claims end_names; ///< of peers and gateways (ADR-02)
  claims<std::int64_t> end_ids;
};

void read_ecology(table_reader& root, ecology_description& out);
void read_radio(table_reader& root, radio::channel_config& out);
[[nodiscard]] std::vector<host_description> read_hosts(table_reader& root);

/// [[island]] with all its motes, ascending by id.
[[nodiscard]] std::vector<island_description> read_islands(table_reader& root, surroundings& with);

/// [[island.mote]]
void read_motes(table_reader& island, surroundings& with, island_description& out);

/// [[air]]; an island that no table names gets an air of its own.
[[nodiscard]] std::vector<air_description>
read_airs(table_reader& root, const directory& names,
          const std::vector<island_description>& islands);

/// [[peer]], ascending by id. `islands` are those that a proxy manager serves by default.
[[nodiscard]] std::vector<peer_description>
read_peers(table_reader& root, surroundings& with, const std::vector<island_description>& islands);

/// links = ["inproc://NAME"]
[[nodiscard]] std::vector<std::string> read_links(table_reader& in, const directory& names,
                                                  const std::string& own_name);

[[nodiscard]] std::vector<proxy::proxy_class> read_proxies(table_reader& root);

/// [[fault]], ascending by time; none may be later than `length`.
[[nodiscard]] std::vector<fault_description> read_faults(table_reader& root, const directory& names,
                                                         duration length);

} // namespace rubicon::config
