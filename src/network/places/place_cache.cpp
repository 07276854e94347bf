#include "network/places/place_cache.hpp"

#include <algorithm>

namespace rubicon::network {

void place_cache::learn(mote_id mote, virtual_coordinates place, instant now) {
  if (motes_max_ == 0)
    return;
  auto at = std::ranges::lower_bound(entries_, mote, {}, &entry::mote);
  if (at != entries_.end() && at->mote == mote) {
    *at = {mote, place, now};
    return;
  }
  if (entries_.size() >= motes_max_) {
    entries_.erase(std::ranges::min_element(entries_, {}, &entry::learnt));
    at = std::ranges::lower_bound(entries_, mote, {}, &entry::mote);
  }
  entries_.insert(at, {mote, place, now});
}

const place_cache::entry* place_cache::entry_of(mote_id mote) const {
  const auto at = std::ranges::lower_bound(entries_, mote, {}, &entry::mote);
  return at != entries_.end() && at->mote == mote ? &*at : nullptr;
}

std::optional<virtual_coordinates> place_cache::find(mote_id mote, instant now) const {
  const auto* const x = entry_of(mote);
  const bool is_known = x != nullptr && (lifetime_ == 0ns || now - x->learnt < lifetime_);
  return is_known ? std::optional(x->place) : std::nullopt;
}

std::optional<virtual_coordinates> place_cache::find_old(mote_id mote) const {
  const auto* const x = entry_of(mote);
  return x != nullptr ? std::optional(x->place) : std::nullopt;
}

bool place_cache::keep_epoch(std::uint16_t epoch) {
  if (epoch == epoch_)
    return false;
  epoch_ = epoch;
  entries_.clear();
  return true;
}

} // namespace rubicon::network
