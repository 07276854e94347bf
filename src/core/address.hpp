// Who is addressed: islands, motes and peers (D1.1 5.2, ADR-01..09, A-01).
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <string>

#include "core/describe/fields.hpp"

namespace rubicon {

/// A number that is only ever one kind of thing.
template <class Tag, class Rep>
struct strong_id {
  using rep = Rep;

  Rep value{};

  constexpr strong_id() = default;
  constexpr explicit strong_id(Rep x) : value(x) {}

  friend constexpr auto operator<=>(strong_id, strong_id) = default;
};

template <class Tag, class Rep>
[[nodiscard]] std::string to_string(strong_id<Tag, Rep> x) {
  return std::to_string(x.value);
}

struct island_tag;
struct mote_tag;
struct peer_tag;

/// An island: the PEIS id of its gateway. Motes carry it as one octet, 1..254 (ADR-03).
using island_id = strong_id<island_tag, std::uint32_t>;

/// A mote inside its island: its TinyOS id, 1..65532 (ADR-04).
using mote_id = strong_id<mote_tag, std::uint16_t>;

/// A PEIS kernel: 1..65535 (peis-wire.md 1); -1 stands for everybody or nobody known.
using peer_id = strong_id<peer_tag, std::int32_t>;

inline constexpr island_id own_island{255};      ///< "myself", ADR-03
inline constexpr mote_id broadcast_mote{0xffff}; ///< everybody in the island, ADR-05
inline constexpr mote_id own_mote{0xfffe};       ///< "myself", ADR-06
inline constexpr mote_id no_mote{0xfffd};        ///< the PC or robot of the island part, ADR-07
inline constexpr mote_id default_sink{1};        ///< ADR-09
inline constexpr peer_id any_peer{-1};

/// Largest ids that a file may give.
inline constexpr std::uint32_t island_id_max = 254;
inline constexpr std::uint16_t mote_id_max = 0xfffc;
inline constexpr std::int32_t peer_id_max = 65535;

/// A mote anywhere in the ecology (ADR-01).
struct mote_address {
  island_id island;
  mote_id mote;

  friend constexpr auto operator<=>(const mote_address&, const mote_address&) = default;
};
RUBICON_FIELDS(mote_address, island, mote);

/// `island/mote` in decimal.
[[nodiscard]] inline std::string to_string(const mote_address& x) {
  return to_string(x.island) + '/' + to_string(x.mote);
}

/// The peer that is an island's gateway.
[[nodiscard]] constexpr peer_id gateway_of(island_id x) {
  return peer_id{static_cast<std::int32_t>(x.value)};
}

/// A place in metres, in a right-handed frame that the file's author chooses.
struct position {
  double x_m = 0;
  double y_m = 0;
  double z_m = 0;

  friend bool operator==(const position&, const position&) = default;
};
RUBICON_FIELDS(position, x_m, y_m, z_m);

} // namespace rubicon

template <class Tag, class Rep>
struct std::hash<rubicon::strong_id<Tag, Rep>> {
  std::size_t operator()(rubicon::strong_id<Tag, Rep> x) const noexcept {
    return std::hash<Rep>{}(x.value);
  }
};
