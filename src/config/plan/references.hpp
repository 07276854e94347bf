// Values that name something else of the file. The kinds that rooms have are in values.hpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/plan/expectation.hpp"
#include "config/toml/values.hpp"

namespace rubicon::config {

/// An island by its name, or "*" for any_island where that is allowed.
struct island_name {
  using type = island_id;
  bool any = false;
  [[nodiscard]] std::optional<island_id> read(const node& x, const asker& who) const;
  [[nodiscard]] form takes() const {
    return string_form(any ? "name of an island, or `\"*\"`" : "name of an island");
  }
};

/// A peer or gateway by its name, or "*" for any_peer.
struct peer_name {
  using type = peer_id;
  [[nodiscard]] std::optional<peer_id> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() { return string_form("name of a peer or gateway, or `\"*\"`"); }
};

/// A gateway by its name.
struct gateway_name {
  using type = peer_id;
  [[nodiscard]] static std::optional<peer_id> read(const node& x, const asker& who);
  [[nodiscard]] static form takes() { return string_form("name of a gateway"); }
};

/// The sink of an island with a gateway by the island's name, or "*" for any_island.
struct joined_sink_name {
  using type = island_id;
  [[nodiscard]] static std::optional<island_id> read(const node& x, const asker& who);
  [[nodiscard]] static form takes() { return island_name{true}.takes(); }
};

/// A peer or gateway by its name, or all peers of a table with a `count` by its name.
struct peer_group_name {
  using type = std::vector<peer_id>;
  [[nodiscard]] std::optional<type> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() { return string_form("name of a peer or gateway"); }
};

/// The two or more peers of which a link has both ends.
struct linked_peers {
  using type = std::vector<peer_id>;
  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who);
  [[nodiscard]] static form takes();
};

/// Groups that have no peer in common.
struct peer_groups {
  using type = std::vector<std::vector<peer_id>>;
  [[nodiscard]] static std::optional<type> read(const node& x, const asker& who);
  [[nodiscard]] static form takes();
};

/// The name of a mote type.
struct mote_type_name {
  using type = std::string;
  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who);
  [[nodiscard]] static form takes() { return string_form("name of a mote type"); }
};

/// "kitchen/fan", "kitchen" or "*".
struct scope_name {
  using type = mote_scope;
  [[nodiscard]] static std::optional<mote_scope> read(const node& x, const asker& who);
  [[nodiscard]] static form takes() { return string_form("island, mote or `\"*\"`"); }
};

/// A node as node_name has it, or "*"; its name as the file has it.
struct any_node_name {
  using type = std::string;
  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who);
  [[nodiscard]] static form takes() { return string_form("mote, name of a peer, or `\"*\"`"); }
};

/// The prefix of a proxy's keys, or "*".
struct proxy_name {
  using type = std::string;
  [[nodiscard]] static std::optional<std::string> read(const node& x, const asker& who);
  [[nodiscard]] static form takes() {
    return string_form("prefix of its keys, as in `\"kitchen.fan\"`, or `\"*\"`");
  }
};

/// A mote as "island/mote", or a sink as "island/sink".
struct radio_name {
  using type = mote_address;
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
  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() { return string_form("name of a host"); }
};

/// The other end of a link, "inproc://NAME"; the value is NAME.
struct link_end {
  using type = std::string;
  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() { return string_form("link"); }
};

/// A tuple of a peer or gateway, "NAME:KEY", or of a peer that the file does not have, "ID:KEY"; or
/// "nowhere". The value is a meta tuple's: `(META <owner> <key>)`.
struct tuple_reference {
  using type = std::string;
  [[nodiscard]] std::optional<std::string> read(const node& x, const asker& who) const;
  [[nodiscard]] static form takes() {
    return string_form("tuple, as in `\"robot:robot.state\"`, or `\"nowhere\"`");
  }
};

} // namespace rubicon::config
