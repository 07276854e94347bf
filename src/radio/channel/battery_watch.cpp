#include "radio/channel/battery_watch.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::radio {

namespace {

/// A battery is asked whether it is flat no more often than this.
constexpr duration battery_check = 10ms;

} // namespace

void battery_watch::begin(instant now) {
  begun_at_ = now;
  runs_low_ = false;
}

std::optional<instant> battery_watch::next_look(const energy_meter& meter, instant now) {
  lasts_until_ = meter.lasts_until(now);
  const auto reserve_mah = runs_low_ ? 0 : meter.battery_mah() * battery_reserve;
  const auto lasts = meter.lasts_until(now, reserve_mah);
  if (lasts == instant::max())
    return std::nullopt;
  return std::max(lasts, now + battery_check);
}

battery_watch::finding battery_watch::look(const energy_meter& meter, instant now) {
  const auto left_mah = meter.battery_mah() - meter.used_mah(now);
  const bool is_low = left_mah <= meter.battery_mah() * battery_reserve;
  return {.runs_low = is_low && !std::exchange(runs_low_, true), .is_flat = left_mah <= 0};
}

void battery_watch::run_down(instant now) {
  flat_at_ = now;
  lasts_until_ = instant::max();
}

energy_use battery_watch::use(const energy_meter& meter, const energy_times& times,
                              instant now) const {
  return {.times = times,
          .charges = meter.charges_of(times),
          .radio_on = meter.state() != radio_state::off,
          .elapsed = std::min(now, flat_at_) - begun_at_,
          .used_mah = meter.used_mah(now),
          .battery_mah = meter.battery_mah(),
          .empty_at = meter.empty_at(now)};
}

} // namespace rubicon::radio
