// Times of which the wire has the low 32 bits (RFC 1982 has the arithmetic).
#pragma once

#include <cstdint>

namespace rubicon {

/// The number whose low 32 bits came over the wire, of all those the one nearest to what is known
/// already: right as long as the two differ by less than 2^31.
[[nodiscard]] constexpr std::int64_t unwrapped(std::uint32_t wire, std::int64_t around) {
  const auto apart = static_cast<std::int32_t>(wire - static_cast<std::uint32_t>(around));
  return around + apart;
}

} // namespace rubicon
