// The motes of one island, one by one and in groups.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "apps/traffic.hpp"
#include "config/file_readers.hpp"

namespace rubicon::config {

/// Reads the motes of an island and checks them against each other, the sink and the radio.
class island_motes {
public:
  /// @param sink_is_good no mistake in [island.sink]: motes may be measured against it
  island_motes(surroundings& with, island_description& island, bool sink_is_good);

  /// The sink's programs, and its place in the medium; before any mote.
  void add_sink(table_reader& island, std::vector<placed_app> apps, mark at);

  void read_mote(table_reader& in);  ///< [[island.mote]]
  void read_group(table_reader& in); ///< [[island.group]], after all single motes

  /// Puts the motes in order, checks that flows have both ends and that radios connect the island.
  /// A real mote of the island has this name.
  void add_name(const std::string& name, mark at, complaints& problems) {
    names_.add(name, "mote name", at, problems);
  }

  void finish(complaints& problems);

private:
  /// A sender, and where the file says where to.
  struct placed_flow {
    mote_id to;
    std::optional<mote_id> via;
    mark to_at;
    mark via_at;

    friend auto operator<=>(const placed_flow&, const placed_flow&) = default;
  };

  [[nodiscard]] bool joins() const { return island_.stack == stack::full; }
  mote_profile read_profile_of(table_reader& in);
  void check_stack(const table_reader& in, const mote_profile& profile) const;
  void read_backbone(table_reader& in, mote_description& out);
  void check_firmware(const table_reader& in, const firmware::program_config& x, mark at) const;
  void check_mac_profile(const table_reader& in, const mote_profile& profile) const;
  void read_layout_of(table_reader& in, std::uint32_t first, std::vector<mote_description>& motes);
  void add_group(table_reader& in, std::uint32_t first, std::uint32_t count,
                 const mote_description& like, const std::string& prefix);
  [[nodiscard]] bool add_id(mote_id id, mark at, complaints& problems);
  void check_connectivity(complaints& problems) const;
  [[nodiscard]] bool check_node(mote_id id, const std::string& name, mark at,
                                complaints& problems) const;
  void note_flows(mote_id from, const std::vector<placed_app>& apps, complaints& problems);
  void note_programs(const std::vector<placed_app>& placed, std::size_t begin,
                     complaints& problems);
  [[nodiscard]] std::string name_of(mote_id id) const;

  surroundings& with_;
  island_description& island_;
  uniqueness<std::uint16_t> ids_;
  std::set<std::uint32_t> taken_; ///< of them and the sink's, in order
  name_uniqueness names_;
  std::optional<double> range_m_;     ///< of all radios, if a disk
  std::map<mote_id, mark> placed_at_; ///< where the file says where each mote stands
  bool positions_matter_ = true;
  std::map<placed_flow, mote_id> flows_; ///< and the first mote that sends so
  std::map<mote_id, mote_id> relays_;    ///< and where each passes on to
  std::set<mote_id> receivers_;
  apps::traffic traffic_;               ///< of all motes with synaptic channels
  std::map<mote_id, mark> programs_at_; ///< of these
  mark vectors_at_;                     ///< the last of these
};

} // namespace rubicon::config
