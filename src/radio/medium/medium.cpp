#include "radio/medium/medium.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/numbers/math.hpp"

namespace rubicon::radio {

namespace {

constexpr double lock_sinr_db = -5;
constexpr double capture_sinr_db = 3;

/// A chance of damage below this is not worth a die.
constexpr double harmless = 1e-12;

double bits(duration x) {
  return static_cast<double>(x.count()) / 4000; // 250 kbit/s: 4 us a bit
}

/// Readings of a noise trace last a millisecond.
instant next_reading(instant now) {
  return instant(std::chrono::floor<std::chrono::milliseconds>(now.time_since_epoch()) + 1ms);
}

power_units reading_in_units(std::int8_t dbm) {
  static const auto table = [] {
    std::array<power_units, 256> all{};
    for (int i = 0; i < 256; ++i)
      all[static_cast<std::size_t>(i)] = to_units(std::min(i - 128, 30));
    return all;
  }();
  return table[static_cast<std::size_t>(dbm + 128)];
}

/// Of a received copy. @param damage to it, @param noise_damage by noise alone
outcome fate(double damage, double noise_damage, random_stream& rng) {
  if (damage < harmless)
    return outcome::intact;
  const auto die = rng.unit();
  // exp(-x) >= 1 - x: mostly that decides, less what rounding could take from it.
  if (die < 1 - damage - harmless || die < math::exp(-damage))
    return outcome::intact;
  return die < math::exp(-noise_damage) ? outcome::collision : outcome::weak;
}

} // namespace

medium::medium(const channel_config& config)
    : errors_(config.curve), disk_(std::holds_alternative<unit_disk>(config.propagation)),
      strict_(config.collisions == collision_rule::strict), capture_(config.capture),
      sense_energy_(config.sensing != sensing::carrier),
      sense_carrier_(config.sensing != sensing::energy),
      whole_window_(config.window == sensing_window::whole), lock_ratio_(from_db(lock_sinr_db)),
      capture_ratio_(from_db(capture_sinr_db)) {}

void medium::add(transceiver_config config, const energy_meter& meter, instant now) {
  head x;
  filter who;
  who.address = config.address;
  who.pan = config.pan;
  who.flags = config.promiscuous ? promiscuous : 0;
  tail y;
  y.meter = meter;
  y.meter.enter(radio_state::listen, now);
  y.noise = config.noise;
  y.own_noise = config.own_noise;
  y.traced_noise = std::move(config.traced_noise);
  has_traced_noise_ = has_traced_noise_ || y.traced_noise != nullptr;
  if (!disk_) {
    y.sensitivity = static_cast<float>(to_units(config.sensitivity_dbm));
    const auto threshold = to_units(config.cca_dbm);
    x.cca_floor = threshold > y.noise ? static_cast<float>(threshold - y.noise) : 0;
  }
  const auto noise = static_cast<double>(std::max(y.noise, y.own_noise));
  x.lock_floor = std::max(y.sensitivity, static_cast<float>(noise * lock_ratio_));
  highest_lock_floor_ = std::max(highest_lock_floor_, x.lock_floor);
  filters_.push_back(who);
  heads_.push_back(x);
  tails_.push_back(std::move(y));
}

slot_index medium::start(transmission x, std::shared_ptr<const hearers> heard_by) {
  visit_hearers();
  const auto slot = free_slot();
  const auto now = x.begin;
  auto& sender = heads_[x.from.value];
  assert(filters_[x.from.value].state == mode::listening);
  if (sender.locked != nothing) {
    spoil_locked(x.from, outcome::half_duplex);
    unlock(sender, now);
  }
  filters_[x.from.value].state = mode::sending;
  tails_[x.from.value].sending = slot;
  tails_[x.from.value].meter.enter(radio_state::transmit, now);

  auto& sent = on_air_[slot];
  sent.what = std::move(x);
  sent.heard_by = std::move(heard_by);
  ++sent.stamp;
  lone_ = slot;
  if (free_.size() + 1 != on_air_.size() || !noises_.empty() || has_traced_noise_)
    visit_hearers();
  return slot;
}

/// What has been put off at the beginning of the lone frame; nothing if there is none.
void medium::visit_hearers() {
  if (lone_ == nothing)
    return;
  const auto slot = std::exchange(lone_, nothing);
  auto& sent = on_air_[slot];
  sent.outcomes.resize(sent.heard_by->size());
  std::uint32_t place = 0;
  for (const auto& x : *sent.heard_by) {
    sent.outcomes[place] = meet(x, slot, place, sent.what.begin);
    ++place;
  }
}

/// The copy of the lone frame at a radio; nullptr: there is none.
const hearer* medium::lone_copy(radio_index radio) const {
  return lone_ != nothing ? link_to(*on_air_[lone_].heard_by, radio) : nullptr;
}

/// Whether the radio receives its copy of the lone frame.
bool medium::locks_on_lone(const hearer& x) const {
  const auto& at = filters_[x.radio.value];
  return at.state == mode::listening && x.power >= heads_[x.radio.value].lock_floor &&
         ((at.flags & turning) == 0 || on_air_[lone_].what.begin >= turned_back(x.radio));
}

void medium::cut(slot_index slot) {
  visit_hearers();
  for (auto& x : on_air_[slot].outcomes)
    if (x == outcome::intact)
      x = outcome::off;
}

void medium::start_noise(radio_index from, std::shared_ptr<const hearers> heard_by, instant now) {
  visit_hearers();
  for (const auto& x : *heard_by) {
    auto& at = heads_[x.radio.value];
    ++at.audible;
    if (at.locked != nothing) {
      if (strict_)
        spoil_locked(x.radio, outcome::collision);
      count_damage(x.radio, now);
      filters_[x.radio.value].flags |= interfered;
    }
    at.power += units_of(x);
  }
  noises_.emplace_back(from, std::move(heard_by));
}

void medium::end_noise(radio_index from, instant now) {
  const auto ended = std::ranges::find(noises_, from, [](const auto& x) { return x.first; });
  assert(ended != noises_.end());
  for (const auto& x : *ended->second) {
    auto& at = heads_[x.radio.value];
    if (at.locked != nothing)
      count_damage(x.radio, now);
    if (sense_energy_ && static_cast<float>(at.power) >= at.cca_floor)
      at.busy_until = now;
    at.power -= units_of(x);
    --at.audible;
  }
  noises_.erase(ended);
}

void medium::switch_on(radio_index radio, instant now) {
  visit_hearers_for(radio);
  filters_[radio.value].state = mode::listening;
  meter(radio).enter(radio_state::listen, now);
}

void medium::switch_off(radio_index radio, instant now) {
  visit_hearers_for(radio);
  auto& x = heads_[radio.value];
  assert(filters_[radio.value].state != mode::sending);
  if (x.locked != nothing) {
    spoil_locked(radio, outcome::off);
    unlock(x, now);
  }
  filters_[radio.value].state = mode::off;
  meter(radio).enter(radio_state::off, now);
}

bool medium::clear(radio_index radio, instant now) {
  const auto since = now - timing::cca;
  if (filters_[radio.value].state != mode::listening || turned_back(radio) > since)
    return false;
  if (whole_window_ && busy_until(radio) > since)
    return false;
  return !senses(radio, now);
}

bool medium::was_busy(radio_index radio, instant since, instant now) {
  return busy_until(radio) > since || senses(radio, now);
}

/// When the channel last was busy. @pre no lone frame but the last one matters
instant medium::busy_until(radio_index radio) const {
  const auto& x = heads_[radio.value];
  const auto filtered = filtered_.last_end();
  if (filtered <= x.busy_until || filtered == x.excepted)
    return x.busy_until;
  const auto* const copy = filtered_.last_copy(radio);
  const bool was_busy =
      copy != nullptr && (sense_carrier_ || (sense_energy_ && copy->power >= x.cca_floor));
  return was_busy ? filtered : x.busy_until;
}

/// Energy or a carrier, by the rule for sensing.
bool medium::senses(radio_index radio, instant now) {
  const auto& x = heads_[radio.value];
  const auto* const lone = lone_copy(radio);
  const bool is_locked = lone != nullptr ? locks_on_lone(*lone) : x.locked != nothing;
  if (sense_carrier_ && is_locked)
    return true;
  if (!sense_energy_)
    return false;
  if (disk_)
    return x.audible != 0 || lone != nullptr;
  auto power = lone != nullptr ? static_cast<double>(lone->power) : static_cast<double>(x.power);
  if (tails_[radio.value].traced_noise != nullptr) {
    if (is_locked)
      count_damage(radio, now); // readings are taken in order of time
    power += static_cast<double>(reading_at(radio, now));
  }
  return power >= static_cast<double>(x.cca_floor);
}

bool medium::stays_clear(radio_index radio, instant later) const {
  const auto since = later - timing::cca;
  const bool silent = free_.size() == on_air_.size() && noises_.empty();
  const bool noise_is_quiet = disk_ || !sense_energy_ || heads_[radio.value].cca_floor > 0;
  return silent && noise_is_quiet && tails_[radio.value].traced_noise == nullptr &&
         filters_[radio.value].state == mode::listening && busy_until(radio) <= since &&
         turned_back(radio) <= since;
}

energy_times medium::times(radio_index radio, instant now) const {
  const auto& x = heads_[radio.value];
  auto all = meter(radio).times(now);
  all.radio_receive = x.received + filtered_.received_by(radio);
  if (const auto* const copy = lone_copy(radio); copy != nullptr && locks_on_lone(*copy))
    all.radio_receive += now - on_air_[lone_].what.begin;
  else if (x.locked != nothing)
    all.radio_receive += now - x.locked_since;
  all.radio_listen -= all.radio_receive;
  return all;
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

// ----------------------------------------------------------------------------- a frame's first bit

/// @returns what is to become of the copy if nothing else happens
outcome medium::meet(const hearer& x, slot_index slot, std::uint32_t place, instant now) {
  auto& at = heads_[x.radio.value];
  auto& who = filters_[x.radio.value];
  const bool alone = at.audible++ == 0;
  if ((who.flags & turning) != 0 && turns_back(x.radio, now)) {
    at.power += units_of(x);
    return outcome::half_duplex;
  }
  if (!alone || who.state != mode::listening || tails_[x.radio.value].traced_noise != nullptr) {
    const auto what = meet_others(x, slot, place, now);
    at.power += units_of(x);
    return what;
  }
  at.power += units_of(x);
  if (x.power < at.lock_floor)
    return outcome::weak;
  lock(at, slot, place, now);
  who.flags &= static_cast<std::uint8_t>(~interfered);
  return outcome::intact;
}

bool medium::turns_back(radio_index radio, instant now) {
  auto& x = filters_[radio.value];
  if (x.state == mode::listening && now < turned_back(radio))
    return true;
  x.flags &= static_cast<std::uint8_t>(~turning);
  return false;
}

/// The same for a transceiver that is not simply listening into silence. `power` is still without
/// the newcomer.
outcome medium::meet_others(const hearer& x, slot_index slot, std::uint32_t place, instant now) {
  auto& at = heads_[x.radio.value];
  auto& who = filters_[x.radio.value];
  auto& rest = tails_[x.radio.value];
  const bool alone = at.audible == 1;
  if (who.state == mode::off)
    return outcome::off;
  if (who.state == mode::sending)
    return outcome::half_duplex;
  if (strict_ && !alone)
    return overlap(x, slot, place, now);
  if (at.locked != nothing)
    count_damage(x.radio, now); // readings are taken in order of time
  const auto noise = static_cast<double>(noise_at(x.radio, now));
  const auto power = static_cast<double>(x.power);
  const bool audible_alone = x.power >= rest.sensitivity && power >= lock_ratio_ * noise;
  const auto disturbance = noise + static_cast<double>(at.power);
  if (at.locked != nothing) {
    who.flags |= interfered;
    if (!audible_alone)
      return outcome::weak;
    if (!capture_ || power < capture_ratio_ * disturbance)
      return outcome::captured;
    spoil_locked(x.radio, outcome::captured);
    unlock(at, now);
  } else if (!audible_alone) {
    return outcome::weak;
  } else if (power < lock_ratio_ * disturbance) {
    return outcome::collision;
  }
  lock(at, slot, place, now);
  who.flags |= interfered; // it is not alone, or its noise changes
  rest.counted_to = now;
  rest.damage = 0;
  rest.noise_damage = 0;
  return outcome::intact;
}

/// Under the strict rule neither frame is received, but a carrier is sensed to the end of the
/// longer.
outcome medium::overlap(const hearer& x, slot_index slot, std::uint32_t place, instant now) {
  auto& at = heads_[x.radio.value];
  spoil_locked(x.radio, outcome::collision);
  if (x.power < at.lock_floor)
    return outcome::weak;
  if (at.locked == nothing || end_of(at.locked) < end_of(slot)) {
    if (at.locked != nothing)
      unlock(at, now);
    lock(at, slot, place, now);
    tails_[x.radio.value].counted_to = now;
  }
  return outcome::collision;
}

instant medium::end_of(slot_index slot) const {
  const auto& x = on_air_[slot].what;
  return x.begin + x.length;
}

void medium::spoil_locked(radio_index radio, outcome cause) {
  const auto& at = heads_[radio.value];
  if (at.locked == nothing)
    return;
  auto& copy = on_air_[at.locked].outcomes[at.place];
  if (copy == outcome::intact) // what spoiled it first stays the cause
    copy = cause;
}

/// Counts the damage to the locked frame since the last time. Call before `power` changes.
void medium::count_damage(radio_index radio, instant now) {
  auto& at = heads_[radio.value];
  auto& rest = tails_[radio.value];
  const auto& locked = on_air_[at.locked];
  const auto& copy = (*locked.heard_by)[at.place];
  const bool is_ack = locked.what.content.type == frame_type::ack;
  const auto frame_bits = bits(locked.what.length);
  if ((filters_[radio.value].flags & interfered) == 0) { // it was alone until now
    rest.counted_to = now;
    rest.noise_damage = static_cast<double>(copy.clean_damage) *
                        errors_.weight(bits(now - at.locked_since), frame_bits, is_ack);
    rest.damage = rest.noise_damage;
    return;
  }
  const auto signal = static_cast<double>(copy.power);
  const auto interference = static_cast<double>(at.power - units_of(copy));
  while (rest.counted_to < now) {
    const auto from = rest.counted_to;
    const auto to = rest.traced_noise == nullptr ? now : std::min(now, next_reading(from));
    const auto noise = static_cast<double>(noise_at(radio, from));
    const auto weight = errors_.weight(bits(to - from), frame_bits, is_ack);
    const auto alone = noise > 0 ? weight * errors_.damage(signal / noise) : 0;
    rest.noise_damage += alone;
    rest.damage +=
        interference > 0 ? weight * errors_.damage(signal / (noise + interference)) : alone;
    rest.counted_to = to;
  }
}

// ------------------------------------------------------------------------------ a frame's last bit

/// What becomes of the locked frame at its end, if nothing has spoiled it.
outcome medium::survive(radio_index radio, instant now, random_stream& rng) {
  count_damage(radio, now);
  const auto& rest = tails_[radio.value];
  return fate(rest.damage, rest.noise_damage, rng);
}

/// The same of a copy that nothing but constant noise has disturbed.
outcome medium::survive_alone(const hearer& x, const transmission& sent, instant now,
                              random_stream& rng) const {
  const bool is_ack = sent.content.type == frame_type::ack;
  const auto damage = static_cast<double>(x.clean_damage) *
                      errors_.weight(bits(now - sent.begin), bits(sent.length), is_ack);
  return fate(damage, damage, rng);
}

/// What disturbs the reception of a frame.
power_units medium::noise_at(radio_index radio, instant now) {
  return std::max(reading_at(radio, now), tails_[radio.value].own_noise);
}

/// What a chip's energy detection would report.
power_units medium::reading_at(radio_index radio, instant now) {
  auto& x = tails_[radio.value];
  return x.traced_noise == nullptr ? x.noise : reading_in_units(x.traced_noise->at(now));
}

void medium::stop_sending(radio_index radio, instant now) {
  filters_[radio.value].state = mode::listening;
  filters_[radio.value].flags |= turning;
  auto& x = tails_[radio.value];
  x.sending = nothing;
  x.sent_until = now;
  x.meter.enter(radio_state::listen, now);
}

/// As if all hearers had received the frame.
void medium::count_filtered(const on_air& sent, instant now) {
  if (filtered_.is_full())
    filtered_.take_out(
        [this](radio_index radio, duration time) { heads_[radio.value].received += time; });
  filtered_.add(sent.heard_by, tails_[sent.what.from.value].filtered, now - sent.what.begin, now);
}

void medium::release(slot_index slot) {
  auto& x = on_air_[slot];
  copies_ += x.heard_by->size();
  x.heard_by.reset();
  x.outcomes.clear();
  x.what.psdu = {};
  x.what.origin = {}; // or a message would stay in transit until the slot is used again
  ++x.stamp;
  free_.push_back(slot);
}

} // namespace rubicon::radio
