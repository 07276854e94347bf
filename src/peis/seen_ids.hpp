// The memory that stops loops and duplicates (peis-wire.md 7, P2P-07).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rubicon::peis {

/// Remembers at least the newest `memory` ids and at most twice as many: two generations of hash
/// tables, of which the older is dropped when the newer is full.
class seen_ids {
public:
  explicit seen_ids(std::size_t memory = 8192) : memory_(memory) {}

  /// @returns false if the id was remembered already
  bool insert(std::int32_t id);

private:
  /// Open addressing; 0 marks a free slot, so id 0 must not be stored.
  class table {
  public:
    [[nodiscard]] bool contains(std::int32_t id) const;
    void insert(std::int32_t id);
    [[nodiscard]] std::size_t size() const { return size_; }

  private:
    [[nodiscard]] std::size_t slot_of(std::int32_t id) const;
    void grow();

    std::vector<std::int32_t> slots_;
    std::size_t size_ = 0;
  };

  table newer_;
  table older_;
  std::size_t memory_;
};

} // namespace rubicon::peis
