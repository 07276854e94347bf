#include "peis/seen_ids.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr std::size_t slots_at_first = 64;

} // namespace

bool seen_ids::insert(peer_id source, std::int32_t id) {
  const auto x = static_cast<std::uint64_t>(static_cast<std::uint32_t>(source.value)) << 32 |
                 static_cast<std::uint32_t>(id);
  if (older_.contains(x) || !newer_.insert(x))
    return false;
  if (newer_.size() >= memory_) {
    std::swap(newer_, older_);
    newer_.clear();
  }
  return true;
}

/// Where the id is, or the free slot where it would go. @pre a slot is free
std::size_t seen_ids::table::slot_of(std::uint64_t x) const {
  const auto mask = slots_.size() - 1;
  auto at = (x * 0x9e3779b97f4a7c15ULL >> 32) & mask;
  while (slots_[at] != 0 && slots_[at] != x)
    at = (at + 1) & mask;
  return at;
}

bool seen_ids::table::contains(std::uint64_t x) const {
  return !slots_.empty() && slots_[slot_of(x)] == x;
}

bool seen_ids::table::insert(std::uint64_t x) {
  assert(x != 0);
  if (2 * (size_ + 1) > slots_.size())
    grow();
  auto& slot = slots_[slot_of(x)];
  if (slot == x)
    return false;
  slot = x;
  ++size_;
  return true;
}

void seen_ids::table::clear() {
  std::fill(slots_.begin(), slots_.end(), 0);
  size_ = 0;
}

void seen_ids::table::grow() {
  const auto old = std::exchange(
      slots_, std::vector<std::uint64_t>(slots_.empty() ? slots_at_first : 2 * slots_.size()));
  for (const auto x : old) {
    if (x != 0)
      slots_[slot_of(x)] = x;
  }
}

} // namespace rubicon::peis
