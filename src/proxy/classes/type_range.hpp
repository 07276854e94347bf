// Which types of motes a proxy class claims: one, a range, or those that agree with a value under a
// mask (PXY-11, PXY-13).
#pragma once

#include <cstdint>

namespace rubicon::proxy {

/// Inclusive range of mote type ids or, with a mask, those whose masked bits are `first`.
struct type_range {
  std::uint32_t first = 0;
  std::uint32_t last = 0; ///< with a mask the same as `first`
  std::uint32_t mask = 0; ///< 0: a range
};

[[nodiscard]] bool holds(const type_range& x, std::uint32_t type);

/// How many types it holds, less one: of those that hold a type the least decides. A range whose
/// `first` is above its `last` holds none.
[[nodiscard]] std::uint32_t width(const type_range& x);

/// Whether there is a type that both hold.
[[nodiscard]] bool overlap(const type_range& a, const type_range& b);

} // namespace rubicon::proxy
