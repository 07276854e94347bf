#include "radio/topology.hpp"

#include <algorithm>
#include <cassert>

#include "core/math.hpp"

namespace rubicon::radio {

namespace {

double distance_m(const position& a, const position& b) {
  return math::length(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

hearers::iterator lower_bound(hearers& list, radio_index radio) {
  return std::lower_bound(list.begin(), list.end(), radio,
                          [](const hearer& x, radio_index y) { return x.radio < y; });
}

int rounded_down(double x) {
  const auto whole = static_cast<int>(x);
  return whole > x ? whole - 1 : whole;
}

} // namespace

signal signal_at(double distance_m) {
  const auto dbm = -40 - 30 * math::log10(std::max(distance_m, 1.0));
  const auto rssi = std::clamp(rounded_down(dbm), -100, 0);
  const auto lqi = std::clamp(110 + 3 * (rssi + 75), 50, 110);
  return {static_cast<std::int8_t>(rssi), static_cast<std::uint8_t>(lqi)};
}

radio_index topology::add(position place) {
  const radio_index radio{static_cast<std::uint32_t>(places_.size())};
  places_.push_back(place);
  around_.push_back(std::make_shared<hearers>());
  connect(radio);
  return radio;
}

void topology::move(radio_index radio, position place) {
  for (const auto& x : *around_[radio.value]) {
    auto& list = editable(x.radio);
    list.erase(lower_bound(list, radio));
  }
  editable(radio).clear();
  places_[radio.value] = place;
  connect(radio);
}

void topology::set_loss(radio_index from, radio_index to, double loss) {
  assert(loss >= 0 && loss <= 1);
  losses_[{from, to}] = loss;
  auto& list = editable(from);
  const auto entry = lower_bound(list, to);
  if (entry != list.end() && entry->radio == to)
    entry->loss = static_cast<float>(loss);
}

void topology::connect(radio_index radio) {
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    const radio_index other{i};
    const auto distance = distance_m(places_[radio.value], places_[i]);
    if (other == radio || distance > range_m_)
      continue;
    const auto heard = signal_at(distance);
    insert(radio, other, heard);
    insert(other, radio, heard);
  }
}

void topology::insert(radio_index from, radio_index to, signal heard) {
  auto& list = editable(from);
  list.insert(lower_bound(list, to), hearer{to, loss_between(from, to), heard});
}

hearers& topology::editable(radio_index radio) {
  auto& list = around_[radio.value];
  if (list.use_count() > 1) // a frame on the air keeps the list it started with
    list = std::make_shared<hearers>(*list);
  return *list;
}

float topology::loss_between(radio_index from, radio_index to) const {
  const auto entry = losses_.find({from, to});
  return static_cast<float>(entry == losses_.end() ? loss_ : entry->second);
}

} // namespace rubicon::radio
