// How a value grows by an append (peis-wire.md 15.5, TUP-07).
#pragma once

#include <cstddef>

#include "core/bytes.hpp"
#include "peis/tuples/tuple.hpp"

namespace rubicon::peis {

inline constexpr std::size_t append_octets_per_unit = 4096; ///< copied, for a unit of work

/// Octets of a value that stay in front of what is appended: all but the trailing NUL of text.
[[nodiscard]] inline std::size_t octets_before_append(const tuple& x) {
  return x.value.size() - (x.form == encoding::text && !x.value.empty() ? 1 : 0);
}

/// The value with `added` behind it.
[[nodiscard]] inline payload appended_value(const tuple& x, const payload& added) {
  const auto head = x.value.view().first(octets_before_append(x));
  const auto tail = added.view();
  bytes all;
  all.reserve(head.size() + tail.size());
  all.insert(all.end(), head.begin(), head.end());
  all.insert(all.end(), tail.begin(), tail.end());
  return all;
}

[[nodiscard]] inline bool ends_with_nul(const payload& x) {
  return !x.empty() && x.view().back() == 0;
}

[[nodiscard]] inline payload with_nul(const payload& x) {
  auto octets = to_bytes(x.view());
  octets.push_back(0);
  return octets;
}

} // namespace rubicon::peis
