// Where the motes of the island are, as far as one mote knows: itself, its neighbours, and those
// whose places it has seen in packets.
#pragma once

#include <cstdint>
#include <optional>

#include "core/bytes.hpp"
#include "network/places/coordinates.hpp"
#include "network/places/place_cache.hpp"

namespace rubicon::network {

class known_places {
public:
  known_places() = default;
  known_places(coordinates own, place_cache others, mote_id self)
      : self_(self), own_(std::move(own)), others_(std::move(others)) {}

  [[nodiscard]] const coordinates& own() const { return own_; }
  [[nodiscard]] coordinates& own() { return own_; }

  void learn(mote_id x, virtual_coordinates place, instant now);
  /// From a frame that passes.
  void learn_from(std::uint8_t am_type, byte_view payload, instant now);

  [[nodiscard]] std::optional<virtual_coordinates> find(mote_id x, instant now) const;
  /// However old.
  [[nodiscard]] std::optional<virtual_coordinates> find_old(mote_id x) const {
    return others_.find_old(x);
  }

  /// Own coordinates may be of another epoch now. @returns whether all others were forgotten
  bool keep_epoch() { return others_.keep_epoch(own_.place_epoch()); }

  [[nodiscard]] std::size_t footprint() const { return others_.footprint(); } ///< without own()

private:
  mote_id self_;
  coordinates own_;
  place_cache others_;
};

} // namespace rubicon::network
