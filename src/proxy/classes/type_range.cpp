#include "proxy/classes/type_range.hpp"

#include <bit>
#include <optional>

namespace rubicon::proxy {

namespace {

/// The least type from `from` on whose masked bits are `value`.
std::optional<std::uint32_t> next_match(std::uint32_t from, std::uint32_t value,
                                        std::uint32_t mask) {
  const auto wrong = (from ^ value) & mask;
  if (wrong == 0)
    return from;
  const auto highest = std::bit_floor(wrong);
  const auto below = highest - 1;
  if ((value & highest) != 0) // larger already, so all free bits below may be 0
    return (from & ~mask & ~below) | value;
  // The free bits above must make up for it: count one up among them.
  const auto filled = from | mask | below | highest;
  if (filled == 0xffffffff)
    return std::nullopt;
  return ((filled + 1) & ~mask) | value;
}

} // namespace

bool holds(const type_range& x, std::uint32_t type) {
  if (x.mask != 0)
    return (type & x.mask) == x.first;
  return type >= x.first && type <= x.last;
}

std::uint32_t width(const type_range& x) {
  if (x.mask == 0)
    return x.last - x.first;
  const auto free_bits = 32 - std::popcount(x.mask);
  return static_cast<std::uint32_t>((std::uint64_t{1} << free_bits) - 1);
}

bool overlap(const type_range& a, const type_range& b) {
  if (a.mask != 0 && b.mask != 0)
    return ((a.first ^ b.first) & a.mask & b.mask) == 0;
  if (b.mask != 0)
    return overlap(b, a);
  if (a.mask == 0)
    return a.first <= b.last && b.first <= a.last;
  const auto least = next_match(b.first, a.first, a.mask);
  return least && *least <= b.last;
}

} // namespace rubicon::proxy
