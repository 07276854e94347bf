// Where other motes of the island are, in virtual coordinates, as far as a mote has learnt it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/time.hpp"
#include "network/places/coordinates.hpp"

namespace rubicon::network {

/// Bounded: a further mote takes the place of the one that was learnt longest ago. Coordinates of
/// one epoch mean nothing in another.
class place_cache {
public:
  place_cache() = default;
  /// @param lifetime after which a place must be learnt again; 0: never
  place_cache(std::size_t motes_max, duration lifetime)
      : motes_max_(motes_max), lifetime_(lifetime) {}

  void learn(mote_id mote, virtual_coordinates place, instant now);
  [[nodiscard]] std::optional<virtual_coordinates> find(mote_id mote, instant now) const;
  /// However long ago: for who cannot learn it again.
  [[nodiscard]] std::optional<virtual_coordinates> find_old(mote_id mote) const;

  /// Forgets all that is not of this epoch. @returns whether it is another one
  bool keep_epoch(std::uint16_t epoch);

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] std::size_t footprint() const { return motes_max_ * (2 + 3 + 1) + 2; }

private:
  struct entry {
    mote_id mote;
    virtual_coordinates place;
    instant learnt;
  };

  [[nodiscard]] const entry* entry_of(mote_id mote) const;

  std::size_t motes_max_ = 0;
  duration lifetime_{};
  std::uint16_t epoch_ = 0;
  std::vector<entry> entries_; ///< ascending by mote
};

} // namespace rubicon::network
