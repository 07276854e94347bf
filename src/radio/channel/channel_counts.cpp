#include "radio/channel/channel_counts.hpp"

#include <algorithm>

namespace rubicon::radio {

std::vector<radio_counters> channel_counts::by_radio() const {
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

radio_counters channel_counts::by(radio_index radio) const {
  return by_radio()[radio.value];
}

radio_counters channel_counts::in_pan(std::uint16_t pan) const {
  const auto all = by_radio();
  radio_counters sum;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (stations_[i].pan == pan)
      sum += all[i];
  return sum;
}

radio_counters channel_counts::by_all() const {
  radio_counters sum;
  for (const auto& x : by_radio())
    sum += x;
  return sum;
}

copy_counters channel_counts::on_link(radio_index from, radio_index to) const {
  const auto& counters = stations_[from.value].copies;
  if (counters.to() == nullptr)
    return {};
  const auto* const found = link_to(*counters.to(), to);
  return found != nullptr ? counters.link(static_cast<std::size_t>(found - counters.to()->data()))
                          : copy_counters{};
}

bool channel_counts::balanced() const {
  for (const auto& x : stations_) {
    const auto links = x.copies.to() == nullptr ? 0 : x.copies.to()->size();
    for (std::size_t place = 0; place < links; ++place)
      if (!x.copies.link(place).balanced())
        return false;
  }
  const auto all = by_radio();
  std::uint64_t copies = 0;
  for (const auto& x : all)
    copies += x.copies.sent;
  return copies == copies_ && std::ranges::all_of(all, &radio_counters::balanced);
}

} // namespace rubicon::radio
