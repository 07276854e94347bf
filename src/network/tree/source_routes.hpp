// What a sink knows of its island's tree: enough to reach every mote that has reported.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "core/address.hpp"

namespace rubicon::network {

/// The last known parent of each mote. Every packet on its way up says its origin's parent.
class source_routes {
public:
  static constexpr std::size_t hops_max = 32;

  source_routes() = default;
  explicit source_routes(mote_id root, std::size_t motes_max = 1000)
      : root_(root), motes_max_(motes_max) {}

  /// @param parent the root itself, or a mote
  void learn(mote_id mote, mote_id parent);
  void forget(mote_id mote) { parents_.erase(mote); }

  /// The hops from the root's neighbour to `mote`, both included; nothing if a parent on the way is
  /// not known, they form a circle, or there are more than hops_max.
  [[nodiscard]] std::optional<std::vector<mote_id>> route_to(mote_id mote) const;

  [[nodiscard]] std::size_t size() const { return parents_.size(); }

private:
  mote_id root_;
  std::size_t motes_max_ =
      1000; ///< a further one takes the place of the one that reported longest ago
  struct entry {
    mote_id parent;
    std::uint64_t learnt = 0; ///< counts what has been learnt
  };

  std::map<mote_id, entry> parents_;
  std::uint64_t learnt_ = 0;
};

} // namespace rubicon::network
