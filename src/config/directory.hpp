// Who is named anywhere in a file, known before its tables are read: so a reference may stand
// before what it refers to, and is resolved where it is read.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "config/document.hpp"
#include "config/values.hpp"
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

/// Names as the file has them. What has no usable name is left out, an unusable id is 0: the reader
/// of its table complains, and nobody else needs to.
struct directory {
  struct island {
    island_id id;
    mote_id sink = default_sink;
    bool has_gateway = true;       ///< it joins the PEIS network
    std::vector<peer_id> gateways; ///< then: its first one, and its aliases
    std::map<std::string, mote_id, std::less<>> motes;
  };

  /// Which ids a group has.
  struct group {
    std::uint32_t first = 1; ///< given, or the lowest from which so many in a row are free: a mote
                             ///< that is added somewhere else does not move a group
    bool fits = true;        ///< all groups so far have at most group_motes_max motes together
  };

  directory() = default;
  explicit directory(const node& root);

  /// The group whose table is there.
  [[nodiscard]] group group_at(mark at) const;

  /// The island with that id; nullptr if there is none.
  [[nodiscard]] const island* find(island_id id) const;

  /// The island with that gateway; nullptr if there is none.
  [[nodiscard]] const island* island_of_gateway(peer_id id) const;

  std::map<std::string, island, std::less<>> islands;
  std::map<std::string, peer_id, std::less<>> ends; ///< of links: peers and gateways
  /// Peers of one table with a `count`, under its name.
  std::map<std::string, std::vector<peer_id>, std::less<>> peer_groups;
  std::map<mark, group> groups; ///< by the places of their tables
  std::set<std::string, std::less<>> hosts;
  std::set<std::string, std::less<>> mote_types;

private:
  void add_gateways(const node& x, const std::string& name, island& of);
};

/// An island by its name, or "*" for any_island where that is allowed.
struct island_name {
  using type = island_id;
  const directory& names;
  bool any = false;
  [[nodiscard]] std::optional<island_id> read(const node& x, const asker& who) const;
  [[nodiscard]] form takes() const {
    return string_form(any ? "name of an island, or `\"*\"`" : "name of an island");
  }
};

/// A peer or gateway by its name, or "*" for any_peer.
struct peer_name {
  using type = peer_id;
  const directory& names;
  [[nodiscard]] std::optional<peer_id> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() { return string_form("name of a peer or gateway, or `\"*\"`"); }
};

/// A peer or gateway by its name, or all peers of a table with a `count` by its name.
struct peer_group_name {
  using type = std::vector<peer_id>;
  const directory& names;
  [[nodiscard]] std::optional<type> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() { return string_form("name of a peer or gateway"); }
};

/// A mote as "island/mote", or "*" for any_mote where that is allowed.
struct mote_name {
  using type = mote_address;
  const directory& names;
  bool any = false;
  [[nodiscard]] std::optional<mote_address> read(const node& x, const asker& who) const;
  [[nodiscard]] form takes() const { return string_form(any ? "mote, or `\"*\"`" : "mote"); }
};

/// A mote as "island/mote", or a sink as "island/sink".
struct radio_name {
  using type = mote_address;
  const directory& names;
  [[nodiscard]] std::optional<mote_address> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() { return string_form("radio"); }
};

/// Where packets of a measuring app go.
struct flow_end {
  std::optional<island_id> island; ///< unset: the island of the app
  std::optional<mote_id> mote;     ///< unset: the sink
};

/// A radio as above, "sink" for that of the own island, or "*" for all who hear.
struct flow_end_name {
  using type = flow_end;
  const directory& names;
  bool broadcast = false; ///< "*" is taken
  [[nodiscard]] std::optional<flow_end> read(const node& x, const asker& who) const;
  [[nodiscard]] form takes() const {
    return string_form("radio of the same island, `\"sink\"`" +
                       std::string(broadcast ? " or `\"*\"`" : ""));
  }
};

/// A host by its name.
struct host_name {
  using type = std::string;
  const directory& names;
  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() { return string_form("name of a host"); }
};

/// The other end of a link, "inproc://NAME"; the value is NAME.
struct link_end {
  using type = std::string;
  const directory& names;
  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() { return string_form("link"); }
};

/// A tuple of a peer or gateway, "NAME:KEY", or of a peer that the file does not have, "ID:KEY"; or
/// "nowhere". The value is a meta tuple's: `(META <owner> <key>)`.
struct tuple_reference {
  using type = std::string;
  const directory& names;
  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() {
    return string_form("tuple, as in `\"robot:robot.state\"`, or `\"nowhere\"`");
  }
};

} // namespace rubicon::config
