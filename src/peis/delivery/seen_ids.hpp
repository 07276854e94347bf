// The memory that stops loops and duplicates (docs/peis-wire.md 7, P2P-07).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "core/address.hpp"
#include "core/numbers/random.hpp"
#include "peis/wire/types.hpp"

namespace rubicon::peis {

/// Remembers up to `memory` ids. Beyond it the oldest go, a thousandth at once, of those that came
/// over the link with the most: of n links each keeps nearly its newest `memory` / n, however much
/// the others bring. What closed links have brought counts as that of one link.
class seen_ids {
public:
  explicit seen_ids(std::size_t memory = 65536, random_stream rng = random_stream());

  /// Ids of different sources are different: real kernels, which compare ids alone, lose a package
  /// now and then.
  /// @returns false if it was remembered already, whichever link it came over. @pre id > 0
  bool insert(peer_id source, std::int32_t id, link_id over = {});

  void on_link_closed(link_id link);

  [[nodiscard]] std::size_t size() const { return size_; }

private:
  using ages = std::deque<std::uint64_t>; ///< oldest first

  [[nodiscard]] std::size_t home_of(std::uint64_t x) const;
  [[nodiscard]] std::size_t slot_of(std::uint64_t x) const;
  void erase(std::uint64_t x);
  void grow();
  void forget_one();

  std::size_t memory_;
  /// A sender that does not know it cannot choose ids that meet in the table.
  std::uint64_t secret_;
  /// Open addressing over source and id in one word; 0 marks a free slot.
  std::vector<std::uint64_t> slots_;
  std::size_t size_ = 0;
  std::map<link_id, ages> links_;
  ages closed_;
};

} // namespace rubicon::peis
