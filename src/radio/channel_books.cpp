// What a channel tells about itself.
#include "radio/channel.hpp"

namespace rubicon::radio {

books channel::counted_by(radio_index radio) const {
  auto x = at(radio).counted;
  x.requests.open = at(radio).sender.open();
  return x;
}

books channel::counted_in_pan(std::uint16_t pan) const {
  books sum;
  for (std::uint32_t i = 0; i < stations_.size(); ++i)
    if (stations_[i].pan == pan)
      sum += counted_by(radio_index{i});
  return sum;
}

books channel::counted() const {
  books sum;
  for (std::uint32_t i = 0; i < stations_.size(); ++i)
    sum += counted_by(radio_index{i});
  return sum;
}

bool channel::balanced() const {
  for (std::uint32_t i = 0; i < stations_.size(); ++i)
    if (!counted_by(radio_index{i}).balanced())
      return false;
  return counted().copies.sent == medium_.copies();
}

energy_use channel::energy(radio_index radio, instant now) const {
  const auto& meter = medium_.meter(radio);
  return {meter.times(now), meter.used_mah(now), meter.battery_mah(), meter.empty_at(now)};
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
