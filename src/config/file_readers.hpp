// Reads the tables of a file. Each function describes one kind of table; load.cpp calls them.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "config/island/mote_readers.hpp"
#include "config/load.hpp"
#include "config/plan/ecology.hpp"
#include "config/plan/references.hpp"
#include "config/plan/uniqueness.hpp"
#include "config/toml/table_reader.hpp"

namespace rubicon::config {

/// Where the files come from that a TOML file names.
struct named_files {
  std::string toml; ///< names are relative to its folder
  overrides instead;
  file_reader read;
  folder_reader list = {};
  extensions known = {};
};

/// What the readers of islands and peers need from the tables before them, and must not share.
struct surroundings {
  surroundings(reading& all, const radio::channel_config& channel, std::uint64_t ecology_seed);

  reading& shared;
  const radio::channel_config& radio;
  bool radio_is_known = true; ///< [radio] is free of mistakes
  std::vector<bool> nodes;    ///< of a topology: whether a gain leads from or to it
  std::uint64_t seed = 1;
  run_mode mode = run_mode::virtual_time;
  duration tick = 500ms;         ///< of the RUBICON clock
  duration day_begins{};         ///< time of day at the start of the run
  std::uint32_t group_motes = 0; ///< of all groups so far
  mote_types types;
  std::set<std::string> types_used;
  name_uniqueness end_names; ///< of peers and gateways (ADR-02)
  uniqueness<std::int64_t> end_ids;
  uniqueness<std::uint32_t> island_ids;
  uniqueness<std::string> files; ///< that recorders write
  label_table labels;
};

/// [[radio.link]], to be checked when the airs are known.
struct placed_links {
  std::vector<mark> at; ///< of each of channel_config::links
  bool sound = true;    ///< all of [radio] is
};

void read_ecology(table_reader& root, ecology_description& out);

/// Complains about an end that the run cannot have. @param x complete but for its expectations
void check_end(table_reader& root, const ecology_description& x);

/// [radio], with the files that it names.
[[nodiscard]] placed_links read_radio(table_reader& root, const named_files& files,
                                      radio::channel_config& out);

/// Complains about links between two airs.
void check_links(const placed_links& links, const radio::channel_config& config,
                 const std::vector<air_description>& airs, complaints& problems);

[[nodiscard]] std::vector<host_description> read_hosts(table_reader& root);

/// [smepp]. Keys that are not given are drawn from the seed.
[[nodiscard]] smepp::group_settings read_smepp(table_reader& root, std::uint64_t seed);

/// [[quantity]], into the quantities that the readers share.
void read_quantities(table_reader& root);

/// [[island]] with all its motes, ascending by id.
[[nodiscard]] std::vector<island_description> read_islands(table_reader& root, surroundings& with);

/// [[air]]; an island that no table names gets an air of its own.
[[nodiscard]] std::vector<air_description>
read_airs(table_reader& root, const std::vector<island_description>& islands);

[[nodiscard]] peis_description read_peis(table_reader& root);

/// [peis.bluetooth], in the table [peis].
void read_bluetooth(table_reader& in, bluetooth_description& out);

[[nodiscard]] std::vector<bluetooth_device> read_bluetooth_devices(table_reader& root);

/// Where the hosts are that peers with adapters share.
using machine_places = std::map<std::string, position>;

/// bluetooth, position and wired of a peer whose other connections are read.
void read_adapters(table_reader& in, run_mode mode, machine_places& places, peer_description& out);

/// [[peer]], ascending by id. `islands` are those that a proxy manager serves by default.
[[nodiscard]] std::vector<peer_description>
read_peers(table_reader& root, surroundings& with, const std::vector<island_description>& islands);

/// links = ["inproc://NAME"]
/// @param own_names of the peers whose links they are
/// @param whom what is said of the key
[[nodiscard]] std::vector<std::string>
read_links(table_reader& in, const std::vector<std::string>& own_names, const char* whom);

/// [[proxy]]. Samplers of `islands` compute what a field says that they do.
/// @param peers complete
/// @param labels to which those of classes are added
[[nodiscard]] std::vector<proxy::proxy_class>
read_proxies(table_reader& root, const proxy::program_registry& programs,
             std::vector<island_description>& islands, const std::vector<peer_description>& peers,
             label_table& labels);

/// Reports classes of tagged objects whose proxies no manager would start.
void check_object_manager(const table_reader& root, const std::vector<peer_description>& peers,
                          const std::vector<proxy::proxy_class>& classes);

/// [mqtt], as an app of its peer. @param out has its peers, proxies and labels
void read_mqtt(table_reader& root, ecology_description& out);

/// [[ros2]], as apps of their peers. @param out has its peers
void read_ros2(table_reader& root, ecology_description& out);

/// app = "rfid_reader" of a peer.
[[nodiscard]] rfid::reader_config read_rfid_reader(table_reader& in, std::string_view peer_name);

/// The texts that `key` of `in` has, with their places.
[[nodiscard]] std::vector<located<std::string>>
texts_at(const table_reader& in, std::string_view key, const std::vector<std::string>& texts);

/// app = "rules" of a peer.
[[nodiscard]] proxy::rules_config read_rules(table_reader& in, const surroundings& with);

/// app = "translate" of a peer.
[[nodiscard]] translate_app read_translate(table_reader& in);

/// app = "goal" of a peer; the name is empty if it has none.
[[nodiscard]] goal::pursuer_config read_pursuer(table_reader& in);

[[nodiscard]] std::vector<tag_description> read_tags(table_reader& root);

/// [[fault]], ascending by time.
[[nodiscard]] std::vector<fault_description>
read_faults(table_reader& root, const surroundings& with,
            const std::vector<island_description>& islands);

/// [[change]], ascending by time. @param all with all that changes can be about
[[nodiscard]] std::vector<fault_description>
read_changes(table_reader& root, const surroundings& with, const ecology_description& all);

/// [[expect]], in the order of the file.
[[nodiscard]] std::vector<expectation> read_expectations(table_reader& root);

} // namespace rubicon::config
