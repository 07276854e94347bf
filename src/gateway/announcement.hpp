// How gateways find each other: what each broadcasts on PEIS port 20 (D1.1 3.1.3; GW-13).
#pragma once

#include <cstdint>
#include <string_view>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::gateway {

/// What stands behind the header of D1.1 5.4 in messages between gateways (WIR-04).
enum class wire_form : std::uint8_t {
  strict54 = 0, ///< the user payload: who sent it within its island is unknown (A-51)
  segment = 1,  ///< a transport::segment, as between our own
};

[[nodiscard]] std::string_view to_string(wire_form x);

struct announcement {
  island_id island; ///< that it serves; its PEIS id may be another (GW-14)
  wire_form form = wire_form::segment;
  std::uint32_t incarnation = 0;

  friend bool operator==(const announcement&, const announcement&) = default;
};

/// uint32 'RUBG', uint8 version 1, uint8 form, uint32 island, uint32 incarnation; network byte
/// order.
[[nodiscard]] bytes encode(const announcement& x);

/// Errors: truncated, bad_value (what other kinds of gateway say, unknown version or form, island
/// 0). Octets after the known ones are for later versions.
[[nodiscard]] result<announcement> decode_announcement(byte_view octets);

} // namespace rubicon::gateway
