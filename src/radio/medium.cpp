#include "radio/medium.hpp"

#include <utility>

namespace rubicon::radio {

void medium::add(const energy_meter& meter, instant now) {
  transceiver x;
  x.meter = meter;
  x.meter.enter(radio_state::listen, now);
  x.quiet_from = now;
  transceivers_.push_back(x);
}

slot_index medium::start(transmission x, std::shared_ptr<const hearers> heard_by, instant now) {
  const auto slot = free_slot();
  auto& sender = transceivers_[x.from.value];
  assert(!sender.sending && sender.meter.state() != radio_state::off);
  spoil_locked(sender, fate::half_duplex);
  sender.locked.reset();
  sender.sending = slot;
  sender.meter.enter(radio_state::transmit, now);

  auto& sent = on_air_[slot];
  sent.what = std::move(x);
  sent.heard_by = std::move(heard_by);
  ++sent.stamp;
  std::uint32_t place = 0;
  for (const auto& y : *sent.heard_by) {
    sent.fates.push_back(meet(transceivers_[y.radio.value], slot, place, now));
    ++place;
  }
  return slot;
}

void medium::cut(slot_index slot) {
  for (auto& x : on_air_[slot].fates)
    if (x == fate::intact)
      x = fate::off;
}

void medium::switch_on(radio_index radio, instant now) {
  transceivers_[radio.value].meter.enter(radio_state::listen, now);
}

void medium::switch_off(radio_index radio, instant now) {
  auto& x = transceivers_[radio.value];
  assert(!x.sending);
  spoil_locked(x, fate::off);
  x.locked.reset();
  x.meter.enter(radio_state::off, now);
}

slot_index medium::free_slot() {
  if (free_.empty()) {
    on_air_.emplace_back();
    return static_cast<slot_index>(on_air_.size() - 1);
  }
  const auto slot = free_.back();
  free_.pop_back();
  return slot;
}

/// A frame begins at a transceiver. @returns what is to become of its copy if nothing else happens
fate medium::meet(transceiver& hearing, slot_index slot, std::uint32_t place, instant now) {
  const bool first = hearing.audible++ == 0;
  if (hearing.meter.state() == radio_state::off)
    return fate::off;
  if (hearing.sending)
    return fate::half_duplex;
  if (!first) {
    spoil_locked(hearing, fate::collision);
    return fate::collision;
  }
  hearing.locked = slot;
  hearing.place_in_locked = place;
  hearing.meter.enter(radio_state::receive, now);
  return fate::intact;
}

void medium::spoil_locked(transceiver& x, fate cause) {
  if (!x.locked)
    return;
  auto& copy = on_air_[*x.locked].fates[x.place_in_locked];
  if (copy == fate::intact) // what spoiled it first stays the cause
    copy = cause;
}

void medium::stop_sending(radio_index radio, instant now) {
  auto& x = transceivers_[radio.value];
  x.sending.reset();
  x.quiet_from = now;
  x.meter.enter(radio_state::listen, now);
}

/// A frame ends at a transceiver.
void medium::silence(radio_index radio, slot_index slot, instant now) {
  auto& x = transceivers_[radio.value];
  --x.audible;
  x.quiet_from = now;
  if (x.locked != slot)
    return;
  x.locked.reset();
  x.meter.enter(radio_state::listen, now);
}

void medium::release(slot_index slot) {
  auto& x = on_air_[slot];
  copies_ += x.heard_by->size();
  x.heard_by.reset();
  x.fates.clear();
  x.what.psdu = {};
  ++x.stamp;
  free_.push_back(slot);
}

} // namespace rubicon::radio
