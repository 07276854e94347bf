// How gateways find each other: what each broadcasts on PEIS port 20 (D1.1 3.1.3; GW-13).
#pragma once

#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "core/tuples/wire_form.hpp"

namespace rubicon::gateway {

struct announcement {
  island_id island; ///< that it serves; its PEIS id may be another (GW-14)
  wire_form form = wire_form::segment;
  std::uint32_t incarnation = 0;
  std::optional<bool> leads = {}; ///< of an island with several gateways: whether this one does

  friend bool operator==(const announcement&, const announcement&) = default;
};

/// uint32 'RUBG', uint8 version 1, uint8 form, uint32 island, uint32 incarnation; and only
/// of one among several gateways uint8 role, 1 stands by or 2 leads; network byte order.
[[nodiscard]] bytes encode(const announcement& x);

/// Errors: truncated, bad_value (what other kinds of gateway say, unknown version or form, island
/// 0). Octets after the known ones are for later versions.
[[nodiscard]] result<announcement> decode_announcement(byte_view octets);

} // namespace rubicon::gateway
