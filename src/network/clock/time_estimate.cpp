#include "network/clock/time_estimate.hpp"

#include <cassert>
#include <cmath>
#include <cstdlib>

namespace rubicon::network {

namespace {

constexpr duration beacon_gap = 20ms; ///< between two that are not the same one

} // namespace

std::chrono::microseconds time_estimate::doubt(instant x) const {
  assert(synchronised());
  if (is_own_)
    return microseconds{0};
  const auto off = disputed_ ? std::abs(disputed_->ahead_us - line_.ahead_us(disputed_->own)) : 0;
  return line_.doubt(x) + microseconds(off);
}

std::optional<tick_setting> time_estimate::tick(instant now) const {
  if (!synchronised())
    return ticks_.at(std::nullopt);
  const auto here = at(now);
  const auto setting = ticks_.at(here);
  const auto network = network_.at(here);
  if (!setting || !network)
    return setting;
  const auto time = here.time_since_epoch() + network->ahead;
  const microseconds period = setting->period;
  const auto number = period_number(time, period);
  return tick_setting{static_cast<std::uint32_t>(number), here - (time - number * period),
                      setting->period};
}

std::optional<duration> time_estimate::network_time(instant x) const {
  if (!synchronised())
    return std::nullopt;
  const auto here = at(x);
  const auto line = network_.at(here);
  return line ? std::optional<duration>(here.time_since_epoch() + line->ahead) : std::nullopt;
}

bool time_estimate::fits(const clock_point& x) const {
  const auto ours = is_own_ ? microseconds{0} : line_.doubt(x.own);
  return std::abs(x.ahead_us - line_.ahead_us(x.own)) <= (outlier + x.doubt + ours).count();
}

/// Whether the point agrees with the one in dispute.
bool time_estimate::is_confirmed_by(const clock_point& x) const {
  if (!disputed_)
    return false;
  const auto between = x.own - disputed_->own;
  const auto drift_max = std::ceil(seconds(between) * clock_line::rate_max * 1e6);
  const auto limit =
      outlier + x.doubt + disputed_->doubt + microseconds(static_cast<std::int64_t>(drift_max));
  return between >= beacon_gap && std::abs(x.ahead_us - disputed_->ahead_us) <= limit.count();
}

point_fate time_estimate::take(const clock_point& x, point_origin origin) {
  if (line_.empty()) {
    line_.restart(x.own, x.ahead_us, x.doubt);
    return point_fate::taken;
  }
  if (fits(x)) {
    disputed_.reset();
    distrusted_ = false;
    if (origin.is_news || x.doubt <= line_.doubt(x.own))
      line_.add(x.own, x.ahead_us, x.doubt);
    return point_fate::taken;
  }
  if (!origin.is_believed && !is_confirmed_by(x)) {
    disputed_ = x;
    return point_fate::disputed;
  }
  last_leap_ = microseconds(x.ahead_us - line_.ahead_us(x.own));
  if (origin.has_leapt)
    line_.shift(last_leap_);
  line_.restart(x.own, x.ahead_us, x.doubt);
  disputed_.reset();
  distrusted_ = false;
  ++steps_;
  return point_fate::restarted;
}

void time_estimate::set(island_time x, instant now) {
  is_own_ = true;
  disputed_.reset();
  distrusted_ = false;
  line_.set(now, x.time_since_epoch().count() - us_of(now));
}

void time_estimate::shift(microseconds by) {
  line_.shift(by);
  if (disputed_)
    disputed_->ahead_us += by.count();
}

void time_estimate::forget() {
  if (line_.empty())
    return;
  line_.clear();
  ++steps_;
}

} // namespace rubicon::network
