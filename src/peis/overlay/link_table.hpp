// The links of a peer, and which neighbours they lead to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "peis/overlay/connection.hpp"
#include "peis/overlay/p2p_config.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// What is known of a link, for kernel.connections, the tools and the report.
struct link_view {
  link_id link;
  std::optional<peer_id> neighbour;
  std::uint64_t octets_in = 0;
  std::uint64_t octets_out = 0;
  double loss = 0;        ///< share of packages that the neighbour sent and we missed, 0..1
  std::size_t queued = 0; ///< packages that wait to leave
};

class link_table {
public:
  /// @param config outlives this
  explicit link_table(const p2p_config& config);

  connection& add(link_id link, instant now); ///< @pre it is not there
  std::optional<connection> take(link_id link);
  void bind(connection& x, peer_id neighbour);

  [[nodiscard]] connection* find(link_id link);
  [[nodiscard]] const connection* find(link_id link) const;
  [[nodiscard]] connection& at(link_id link) { return connections_.at(link); }
  [[nodiscard]] const connection& at(link_id link) const { return connections_.at(link); }
  [[nodiscard]] bool contains(link_id link) const { return connections_.contains(link); }
  [[nodiscard]] std::map<link_id, connection>& all() { return connections_; }
  [[nodiscard]] const std::map<link_id, connection>& all() const { return connections_; }
  [[nodiscard]] std::size_t size() const { return connections_.size(); }
  [[nodiscard]] std::size_t open() const; ///< how many are

  /// The oldest link to a neighbour (peis-wire.md 3.6).
  [[nodiscard]] std::optional<link_id> link_to(peer_id neighbour) const;
  [[nodiscard]] bool is_neighbour(peer_id host) const { return neighbours_.contains(host); }
  [[nodiscard]] std::size_t neighbours() const { return neighbours_.size(); } ///< how many
  [[nodiscard]] std::vector<link_id> links_to(peer_id neighbour) const;
  [[nodiscard]] bool has_named_link(peer_id host) const;

  [[nodiscard]] std::vector<link_view> views() const; ///< ascending by link

private:
  const p2p_config& config_;
  std::shared_ptr<queues_memory> queues_; ///< of all connections
  std::map<link_id, connection> connections_;
  std::map<peer_id, link_id> neighbours_; ///< the oldest link to each
};

} // namespace rubicon::peis
