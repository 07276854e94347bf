// The counters that a channel reports.
#include "radio/medium/channel.hpp"

#include <algorithm>

namespace rubicon::radio {

std::vector<radio_counters> channel::counted_by_radio() const {
  std::vector<radio_counters> all;
  all.reserve(stations_.size());
  for (const auto& x : stations_) {
    all.push_back(x.counted);
    all.back().requests.open = x.sender.open();
  }
  for (const auto& x : stations_)
    x.copies.add_to([&all](radio_index to) -> copy_counters& { return all[to.value].copies; });
  return all;
}

radio_counters channel::counted_by(radio_index radio) const {
  return counted_by_radio()[radio.value];
}

radio_counters channel::counted_in_pan(std::uint16_t pan) const {
  const auto all = counted_by_radio();
  radio_counters sum;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (stations_[i].pan == pan)
      sum += all[i];
  return sum;
}

radio_counters channel::counted() const {
  radio_counters sum;
  for (const auto& x : counted_by_radio())
    sum += x;
  return sum;
}

copy_counters channel::counted_on(radio_index from, radio_index to) const {
  const auto& counters = at(from).copies;
  if (counters.to() == nullptr)
    return {};
  const auto* const found = link_to(*counters.to(), to);
  return found != nullptr ? counters.link(static_cast<std::size_t>(found - counters.to()->data()))
                          : copy_counters{};
}

bool channel::balanced() const {
  for (const auto& x : stations_) {
    const auto links = x.copies.to() == nullptr ? 0 : x.copies.to()->size();
    for (std::size_t place = 0; place < links; ++place)
      if (!x.copies.link(place).balanced())
        return false;
  }
  const auto all = counted_by_radio();
  std::uint64_t copies = 0;
  for (const auto& x : all)
    copies += x.copies.sent;
  return copies == medium_.copies() && std::ranges::all_of(all, &radio_counters::balanced);
}

energy_use channel::energy(radio_index radio, instant now) const {
  const auto& meter = medium_.meter(radio);
  const auto times = medium_.times(radio, now);
  return {.times = times,
          .charges = meter.charges_of(times),
          .radio_on = meter.state() != radio_state::off,
          .elapsed = std::min(now, at(radio).flat_at) - at(radio).added_at,
          .used_mah = meter.used_mah(now),
          .battery_mah = meter.battery_mah(),
          .empty_at = meter.empty_at(now)};
}

instant channel::batteries_last_until() const {
  auto first = instant::max();
  for (const auto& x : stations_)
    if (x.supply != power::flat)
      first = std::min(first, x.lasts_until);
  return first;
}

power channel::power_of(radio_index radio) const {
  return at(radio).supply;
}

std::size_t channel::radios() const {
  return stations_.size();
}

std::vector<radio_index> channel::neighbours(radio_index radio) const {
  std::vector<radio_index> all;
  for (const auto& x : *topology_.around(radio))
    all.push_back(x.radio);
  return all;
}

} // namespace rubicon::radio
