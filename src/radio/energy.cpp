#include "radio/energy.hpp"

#include <algorithm>
#include <cassert>

namespace rubicon::radio {

namespace {

constexpr double seconds_an_hour = 3600;
constexpr double longest_s = 1e9; ///< about 32 years; what is later is "never"

double charge_mah(duration time, double current_ma) {
  return seconds(time) * current_ma / seconds_an_hour;
}

/// When `charge` is used up at a steady current.
instant after(instant from, double charge, double current_ma) {
  const auto needed_s = charge * seconds_an_hour / current_ma; // infinite without a current
  if (!(needed_s < longest_s))
    return instant::max();
  return from + std::chrono::duration_cast<duration>(std::chrono::duration<double>(needed_s));
}

duration& of(radio_state state, energy_times& times) {
  switch (state) {
  case radio_state::listen:
    return times.radio_listen;
  case radio_state::transmit:
    return times.radio_transmit;
  case radio_state::off:
    break;
  }
  return times.radio_off;
}

} // namespace

energy_charges charges_of(const energy_times& times, const platform& kind, double transmit_ma) {
  return {.radio_off = charge_mah(times.radio_off, kind.radio_off_ma),
          .radio_listen = charge_mah(times.radio_listen, kind.radio_listen_ma),
          .radio_receive = charge_mah(times.radio_receive, kind.radio_listen_ma),
          .radio_transmit = charge_mah(times.radio_transmit, transmit_ma),
          .mcu = charge_mah(times.mcu_active, kind.mcu_active_ma) +
                 charge_mah(times.mcu_sleep, kind.mcu_sleep_ma)};
}

double used_mah(const energy_times& times, const platform& kind, double transmit_ma) {
  return charge_mah(times.radio_off, kind.radio_off_ma) +
         charge_mah(times.radio_listen + times.radio_receive, kind.radio_listen_ma) +
         charge_mah(times.radio_transmit, transmit_ma) +
         charge_mah(times.mcu_active, kind.mcu_active_ma) +
         charge_mah(times.mcu_sleep, kind.mcu_sleep_ma);
}

energy_meter::energy_meter(const platform* kind, double battery_mah, double transmit_dbm,
                           instant start)
    : kind_(kind), battery_mah_(battery_mah), transmit_ma_(kind->transmit_ma(transmit_dbm)),
      start_(start), since_(start), busy_until_(start), computes_until_(start) {
  assert(battery_mah > 0);
}

double energy_meter::radio_ma(radio_state x) const {
  switch (x) {
  case radio_state::off:
    return kind_->radio_off_ma;
  case radio_state::listen:
    return kind_->radio_listen_ma;
  case radio_state::transmit:
    return transmit_ma_;
  }
  return 0;
}

void energy_meter::restart(double used_mah, instant now) {
  times_ = {};
  used_before_mah_ = used_mah;
  start_ = since_ = busy_until_ = computes_until_ = now;
}

void energy_meter::enter(radio_state next, instant now) {
  if (stopped_)
    return;
  assert(now >= since_);
  of(state_, times_) += now - since_;
  since_ = now;
  state_ = next;
}

instant energy_meter::work(duration length, instant now) {
  if (stopped_)
    return now;
  extend(busy_until_, computes_until_, length, now);
  return busy_until_;
}

void energy_meter::compute(duration length, instant now) {
  if (stopped_)
    return;
  extend(computes_until_, busy_until_, length, now);
}

/// Books what the other one does not cover: the MCU is active or not.
void energy_meter::extend(instant& until, instant other, duration length, instant now) {
  const auto before = std::max({until, other, now});
  until = std::max(until, now) + length;
  times_.mcu_active += std::max(until, before) - before;
}

duration energy_meter::ahead(instant now) const {
  return std::max({busy_until_, computes_until_, now}) - now;
}

void energy_meter::drop_work(instant now) {
  if (busy_until_ <= now)
    return;
  const auto both = ahead(now);
  busy_until_ = now;
  times_.mcu_active -= both - ahead(now);
}

void energy_meter::stop(instant now) {
  enter(radio_state::off, now);
  if (stopped_)
    return;
  times_.mcu_active -= ahead(now);
  busy_until_ = computes_until_ = now;
  stopped_ = now;
}

energy_times energy_meter::times(instant now) const {
  const auto end = stopped_.value_or(now);
  auto x = times_;
  of(state_, x) += end - since_;
  x.mcu_active -= ahead(end);
  x.mcu_sleep = end - start_ - x.mcu_active;
  return x;
}

double energy_meter::used_mah(instant now) const {
  return used_before_mah_ + radio::used_mah(times(now), *kind_, transmit_ma_);
}

instant energy_meter::empty_at(instant now) const {
  const auto left = battery_mah_ - used_mah(now);
  if (stopped_ || left <= 0)
    return stopped_.value_or(now);
  const auto present_ma = radio_ma(state_);
  const auto busy = ahead(now);
  const auto for_work = charge_mah(busy, present_ma + kind_->mcu_active_ma);
  if (left <= for_work)
    return after(now, left, present_ma + kind_->mcu_active_ma);
  return after(now + busy, left - for_work, present_ma + kind_->mcu_sleep_ma);
}

instant energy_meter::lasts_until(instant now, double reserve_mah) const {
  const auto left = battery_mah_ - reserve_mah - used_mah(now);
  if (stopped_ || left <= 0)
    return now;
  const auto most_ma = std::max({kind_->radio_off_ma, kind_->radio_listen_ma, transmit_ma_}) +
                       std::max(kind_->mcu_active_ma, kind_->mcu_sleep_ma);
  return after(now, left, most_ma);
}

} // namespace rubicon::radio
