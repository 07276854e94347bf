#include "mote/join/slot_table.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::mote {

std::vector<mote_id> slot_table::on_notice(mote_id mote, std::uint16_t units, network::slot_run has,
                                           instant now) {
  std::vector<mote_id> changed;
  const auto held = slot_of(mote);
  const bool fits = held.units == units && held.end() <= room_;
  if (!fits)
    slots_.erase(mote);
  if (units > 0 && !fits) {
    auto first = gap(units);
    if (!first) {
      put_together(changed);
      first = gap(units);
    }
    if (first)
      slots_[mote].slot = {*first, units};
    else
      ++counters_.refused;
  }
  if (const auto found = slots_.find(mote); found != slots_.end())
    found->second.end = now + hold_;
  if (slot_of(mote) != has || (units > 0 && slot_of(mote).units == 0))
    changed.push_back(mote);
  std::ranges::sort(changed);
  return changed;
}

/// The lowest units in a row that are free.
std::optional<std::uint16_t> slot_table::gap(std::uint16_t units) const {
  std::vector<network::slot_run> taken;
  for (const auto& [mote, x] : slots_)
    taken.push_back(x.slot);
  std::ranges::sort(taken, {}, &network::slot_run::first);
  std::size_t first = 0;
  for (const auto& x : taken) {
    if (first + units <= x.first)
      break;
    first = std::max(first, x.end());
  }
  return first + units <= room_ ? std::optional(static_cast<std::uint16_t>(first)) : std::nullopt;
}

/// No gaps are left.
void slot_table::put_together(std::vector<mote_id>& changed) {
  std::uint16_t first = 0;
  for (auto& [mote, x] : slots_) {
    const network::slot_run slot{first, x.slot.units};
    first = static_cast<std::uint16_t>(slot.end());
    if (std::exchange(x.slot, slot) == slot)
      continue;
    ++counters_.moved;
    changed.push_back(mote);
  }
}

void slot_table::on_time(instant now) {
  std::erase_if(slots_, [now](const auto& x) { return x.second.end <= now; });
}

network::slot_run slot_table::slot_of(mote_id mote) const {
  const auto found = slots_.find(mote);
  return found == slots_.end() ? network::slot_run{} : found->second.slot;
}

std::size_t slot_table::used() const {
  std::size_t end = 0;
  for (const auto& [mote, x] : slots_)
    end = std::max(end, x.slot.end());
  return end;
}

std::optional<instant> slot_table::deadline() const {
  std::optional<instant> next;
  for (const auto& [mote, x] : slots_)
    next = earliest(next, x.end);
  return next;
}

} // namespace rubicon::mote
