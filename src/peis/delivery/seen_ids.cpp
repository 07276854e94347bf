#include "peis/delivery/seen_ids.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr std::size_t slots_at_first = 64;
constexpr std::size_t full_quarters = 3; ///< of the slots are taken when their number is doubled
constexpr std::size_t memory_per_search = 1024;

} // namespace

seen_ids::seen_ids(std::size_t memory, random_stream rng) : memory_(memory) {
  static_cast<void>(rng.next()); // the first is one that others see
  secret_ = rng.next();
}

bool seen_ids::insert(peer_id source, std::int32_t id, link_id over) {
  const auto x = static_cast<std::uint64_t>(static_cast<std::uint32_t>(source.value)) << 32 |
                 static_cast<std::uint32_t>(id);
  assert(x != 0);
  if (!slots_.empty() && slots_[slot_of(x)] == x)
    return false;
  if (size_ >= memory_)
    forget_one();
  if (full_quarters * slots_.size() < 4 * (size_ + 1))
    grow();
  slots_[slot_of(x)] = x;
  ++size_;
  links_[over].push_back(x);
  return true;
}

void seen_ids::on_link_closed(link_id link) {
  const auto gone = links_.extract(link);
  if (gone)
    closed_.insert(closed_.end(), gone.mapped().begin(), gone.mapped().end());
}

/// Of one link, the longest, the oldest: a few at once, since to look for it costs as much.
void seen_ids::forget_one() {
  auto* most = &closed_;
  for (auto& [link, x] : links_)
    most = x.size() > most->size() ? &x : most;
  for (auto count = std::min(most->size(), 1 + memory_ / memory_per_search); count > 0; --count) {
    erase(most->front());
    most->pop_front();
  }
}

std::size_t seen_ids::home_of(std::uint64_t x) const {
  auto y = (x ^ secret_) * 0x9e3779b97f4a7c15ULL;
  y = (y ^ y >> 32) * 0xd6e8feb86659fd93ULL;
  return (y >> 32) & (slots_.size() - 1);
}

/// Where the id is, or the free slot where it would go. @pre a slot is free
std::size_t seen_ids::slot_of(std::uint64_t x) const {
  auto at = home_of(x);
  while (slots_[at] != 0 && slots_[at] != x)
    at = (at + 1) & (slots_.size() - 1);
  return at;
}

/// Those behind it that would not be found any more move up.
void seen_ids::erase(std::uint64_t x) {
  const auto mask = slots_.size() - 1;
  auto gap = slot_of(x);
  for (auto at = (gap + 1) & mask; slots_[at] != 0; at = (at + 1) & mask) {
    const auto way = (at - home_of(slots_[at])) & mask;
    if (way < ((at - gap) & mask))
      continue;
    slots_[gap] = slots_[at];
    gap = at;
  }
  slots_[gap] = 0;
  --size_;
}

void seen_ids::grow() {
  const auto old = std::exchange(
      slots_, std::vector<std::uint64_t>(slots_.empty() ? slots_at_first : 2 * slots_.size()));
  for (const auto x : old) {
    if (x != 0)
      slots_[slot_of(x)] = x;
  }
}

} // namespace rubicon::peis
