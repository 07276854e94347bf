// Who has which tuples, who subscribes to them, and where meta tuples point (SVC-07): as text, as
// JSON and for Graphviz.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/address.hpp"
#include "peis/tuples/key.hpp"
#include "peis/tuples/meta_tuple.hpp"
#include "peis/tuples/tuple.hpp"

namespace rubicon::cli {

/// What somebody subscribes to.
struct graph_subscription {
  peer_id host;
  peer_id owner; ///< any_peer: whoever has it
  peis::key wanted;
  std::uint64_t tuples = 0; ///< that are there and fit
};

struct graph_tuple {
  peis::tuple_pointer content;
  std::set<peer_id> subscribers;
  std::optional<peis::meta_reference> meta; ///< unset: it is no meta tuple
};

struct ecology_graph {
  std::map<peer_id, std::string> names; ///< of all peers; empty: it has not described itself
  std::vector<graph_tuple> tuples;      ///< ascending by owner, then key
  std::vector<graph_subscription> subscriptions; ///< ascending by host, owner, key
  std::uint64_t left_out = 0;                    ///< subscriptions behind the first so many
};
inline constexpr std::size_t graph_subscriptions_max = 20'000;

/// The subscriptions at one peer, as it says in its tuple `kernel.subscribers` (peis-wire.md 18).
/// Malformed lines are skipped: any peer may have written the text.
[[nodiscard]] std::vector<graph_subscription> read_subscribers(std::string_view text);

/// @param names of the peers
/// @param tuples all there are, kernel.* included
/// @param self whose subscriptions do not count: the looker's own
/// @param all kernel.* counts
[[nodiscard]] ecology_graph graph_of(std::map<peer_id, std::string> names,
                                     const std::vector<peis::tuple_pointer>& tuples, peer_id self,
                                     bool all);

[[nodiscard]] std::string graph_text(const ecology_graph& x, std::size_t width, bool colour);

/// One JSON object.
[[nodiscard]] std::string to_json(const ecology_graph& x);

/// For `dot`: a box a peer with those of its tuples that somebody subscribes to, that are meta
/// tuples or pointed at; the flow of values, and dashed where meta tuples point.
[[nodiscard]] std::string to_dot(const ecology_graph& x);

} // namespace rubicon::cli
