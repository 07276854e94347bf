// Who is named anywhere in a file. The tables of a file are read twice: first to see who is there,
// then with that known, so that a reference may stand before what it refers to, and is resolved
// where it is read.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "config/plan/ecology.hpp"
#include "core/address.hpp"

namespace rubicon::config {

/// Name of a mote that the file gives none: `climate-7`, or `mote-7` without a mote type.
[[nodiscard]] std::string default_mote_name(std::string_view type_name, mote_id id);

/// Name of an island's gateway that the file gives none: `kitchen-gateway`.
[[nodiscard]] std::string default_gateway_name(std::string_view island);

/// Name of a further gateway of an island: `kitchen-gateway-2`. @param number from 2 on
[[nodiscard]] std::string default_alias_name(std::string_view island, std::size_t number);

/// What a reference calls every island's sink; no mote has this name.
inline constexpr std::string_view sink_name = "sink";

/// Name of one of several peers of a table: `robot-2`; numbers begin with 1.
[[nodiscard]] std::string counted_peer_name(std::string_view name, std::uint32_t number);

/// Peers that one table may have.
inline constexpr std::uint32_t peer_count_max = 1000;

/// Motes that all groups of a file may have together.
inline constexpr std::uint32_t group_motes_max = 100'000;

/// Names as the readers of their tables give them. What has no usable name is left out, an unusable
/// id is 0: the reader reports it, and no other code needs to.
struct directory {
  struct island {
    island_id id;
    mote_id sink = default_sink;
    bool has_gateway = true;       ///< it joins the PEIS network
    bool is_joined = true;         ///< its motes join it
    bool is_simulated = true;      ///< its motes and its sink are
    std::vector<peer_id> gateways; ///< then: its first one, and its aliases
    std::map<std::string, mote_id, std::less<>> motes;
  };

  directory() = default;
  explicit directory(const ecology_description& all);

  /// The island with that id; nullptr if there is none.
  [[nodiscard]] const island* find(island_id id) const;

  /// The island with that gateway; nullptr if there is none.
  [[nodiscard]] const island* island_of_gateway(peer_id id) const;

  std::map<std::string, island, std::less<>> islands;
  std::map<std::string, peer_id, std::less<>> ends; ///< of links: peers and gateways
  /// Peers of one table with a `count`, under its name.
  std::map<std::string, std::vector<peer_id>, std::less<>> peer_groups;
  std::set<std::string, std::less<>> hosts;
  std::set<std::string, std::less<>> groups; ///< of SMEPP Light
  std::set<std::string, std::less<>> mote_types;
};

/// That of a file of which nothing is read yet: it is empty.
[[nodiscard]] std::shared_ptr<const directory> nobody_yet();

} // namespace rubicon::config
