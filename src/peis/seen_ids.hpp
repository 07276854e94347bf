// The memory that stops loops and duplicates (peis-wire.md 7, P2P-07).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/address.hpp"

namespace rubicon::peis {

/// Remembers at least the newest `memory` ids and at most twice as many: two generations of hash
/// tables, of which the older is dropped when the newer is full.
class seen_ids {
public:
  explicit seen_ids(std::size_t memory = 32768) : memory_(memory) {}

  /// Ids of different sources are different: real kernels, which compare ids alone, lose a package
  /// now and then.
  /// @returns false if it was remembered already. @pre id > 0
  bool insert(peer_id source, std::int32_t id);

private:
  /// Open addressing over source and id in one word; 0 marks a free slot.
  class table {
  public:
    [[nodiscard]] bool contains(std::uint64_t x) const;
    bool insert(std::uint64_t x); ///< false: it was there
    void clear();                 ///< keeps the slots for those to come
    [[nodiscard]] std::size_t size() const { return size_; }

  private:
    [[nodiscard]] std::size_t slot_of(std::uint64_t x) const;
    void grow();

    std::vector<std::uint64_t> slots_;
    std::size_t size_ = 0;
  };

  table newer_;
  table older_;
  std::size_t memory_;
};

} // namespace rubicon::peis
