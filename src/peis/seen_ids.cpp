#include "peis/seen_ids.hpp"

#include <cassert>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr std::size_t slots_at_first = 64;

} // namespace

bool seen_ids::insert(std::int32_t id) {
  if (newer_.contains(id) || older_.contains(id))
    return false;
  if (newer_.size() >= memory_)
    older_ = std::exchange(newer_, {});
  newer_.insert(id);
  return true;
}

/// Where the id is, or the free slot where it would go. @pre a slot is free
std::size_t seen_ids::table::slot_of(std::int32_t id) const {
  const auto mask = slots_.size() - 1;
  auto at = (static_cast<std::uint32_t>(id) * 0x9e3779b97f4a7c15ULL >> 32) & mask;
  while (slots_[at] != 0 && slots_[at] != id)
    at = (at + 1) & mask;
  return at;
}

bool seen_ids::table::contains(std::int32_t id) const {
  return !slots_.empty() && slots_[slot_of(id)] == id;
}

void seen_ids::table::insert(std::int32_t id) {
  assert(id != 0);
  if (2 * (size_ + 1) > slots_.size())
    grow();
  slots_[slot_of(id)] = id;
  ++size_;
}

void seen_ids::table::grow() {
  const auto old = std::exchange(
      slots_, std::vector<std::int32_t>(slots_.empty() ? slots_at_first : 2 * slots_.size()));
  for (const auto id : old) {
    if (id != 0)
      slots_[slot_of(id)] = id;
  }
}

} // namespace rubicon::peis
