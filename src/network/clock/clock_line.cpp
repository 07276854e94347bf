#include "network/clock/clock_line.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

namespace rubicon::network {

namespace {

using std::chrono::microseconds;

constexpr microseconds fit_noise{30};  ///< of a point, at least
constexpr duration span_min = 3s;      ///< of points that show a rate,
constexpr duration span_max = 5min;    ///< and of those that show it well: older ones are not used;
constexpr duration span_short = 30s;   ///< nor those older than this of a crystal that wanders fast
constexpr duration gap_shown = 5s;     ///< between points that show whether the rate changes
constexpr double wander_min = 1e-8;    ///< 1/s, what noise may hide: +-9 ppm in an hour
constexpr double wander_margin = 2;    ///< over what was seen, which forgets
constexpr double believed = 0.7;       ///< of what was assumed, when one point shows less
constexpr double wander_memory = 1800; ///< s, within which it does

microseconds rounded_up(double us) {
  return microseconds(static_cast<std::int64_t>(std::ceil(us)));
}

/// As it counts for the line, in microseconds.
double noise_of(microseconds noise) {
  return static_cast<double>(std::max(noise, fit_noise).count());
}

/// 1 for the point with least noise.
double weight_of(microseconds noise, double least) {
  const auto share = least / noise_of(noise);
  return share * share;
}

/// What points at some distances from their middle show of a rate.
class lever {
public:
  void add(double weight, double own_us, double ahead_us, double noise_us) {
    const auto pull = weight * std::abs(own_us);
    pulls_ += pull;
    squares_ += pull * pull;
    noise_ += pull * noise_us;
    covariance_ += weight * own_us * ahead_us;
    variance_ += weight * own_us * own_us;
    skewness_ += weight * own_us * own_us * own_us;
  }

  [[nodiscard]] double slope() const { return covariance_ / variance_; }

  /// By all that the noise of two points can do; many do not all err in the worst way.
  [[nodiscard]] double slope_doubt() const {
    const auto points = pulls_ * pulls_ / squares_;
    return noise_ / variance_ * 2 / points;
  }

  /// Where a clock whose rate changes steadily had this slope: microseconds after the middle.
  [[nodiscard]] double slope_at() const { return skewness_ / variance_ / 2; }

private:
  double pulls_ = 0;
  double squares_ = 0; ///< of pulls
  double noise_ = 0;
  double covariance_ = 0;
  double variance_ = 0;
  double skewness_ = 0;
};

} // namespace

void clock_line::add(instant own, std::int64_t ahead_us, microseconds noise) {
  const point here{own, ahead_us, noise};
  learn_wander(here, noise);
  while (!points_.empty() && own - points_.back().own < gap_shown &&
         points_.back().noise > 2 * noise) // this says the same, and better
    points_.pop_back();
  points_.push_back(here);
  if (points_.size() > points_max)
    points_.erase(points_.begin());
  noise_ = noise;
  fit();
}

void clock_line::restart(instant own, std::int64_t ahead_us, microseconds noise) {
  if (!points_.empty() && own > points_.back().own) {
    const auto since = seconds(own - points_.back().own);
    const auto by_rate = missed({own, ahead_us, noise}) * 1e-6 / since;
    slope_doubt_ = std::min(std::max(slope_doubt_, by_rate), rate_max);
  }
  points_.assign(1, {own, ahead_us, noise});
  noise_ = noise;
  fit();
}

void clock_line::set(instant own, std::int64_t ahead_us) {
  clear();
  middle_ = own;
  middle_ahead_us_ = static_cast<double>(ahead_us);
}

void clock_line::shift(microseconds by) {
  for (auto& x : points_)
    x.ahead_us += by.count();
  middle_ahead_us_ += static_cast<double>(by.count());
}

/// What the line has missed a point by, beyond all noise, comes from a rate that has changed.
void clock_line::learn_wander(const point& x, microseconds noise) {
  if (points_.empty() || slope_doubt_ >= rate_max)
    return;
  const auto since = x.own - points_.back().own;
  if (since < gap_shown)
    return;
  const auto by_all = missed(x);
  const auto by_noise = static_cast<double>((noise_ + noise).count());
  const auto by_one = missed_by_wander(seconds(since));
  const auto seen = std::max(by_all - by_noise, 0.0) / by_one;
  const auto most = wander_margin * (by_all + by_noise) / by_one;
  wander_assumed_ = std::min(wander_assumed_, std::max(most, believed * wander_assumed_));
  const auto kept = std::max(1 - seconds(since) / wander_memory, 0.0);
  wander_seen_ = std::max(wander_seen_ * kept, seen);
}

double clock_line::wander() const {
  return std::max(wander_margin * wander_seen_, wander_assumed_) + wander_min;
}

/// Microseconds for each unit of wander: the rate is that of `lag_` ago, and goes on changing.
double clock_line::missed_by_wander(double since) const {
  return (lag_ * since + since * since / 2) * 1e6;
}

/// Where noise over the span and wander within it make the rate equally wrong.
duration clock_line::span_wanted() const {
  if (wander_seen_ <= 0)
    return span_max;
  const auto best = std::sqrt(static_cast<double>(fit_noise.count()) * 1e-6 / wander_seen_);
  return best >= seconds(span_max)
             ? span_max
             : std::max(span_short, duration(static_cast<duration::rep>(best * 1e9)));
}

/// Least squares through the newest points that span long enough, each of which counts the more the
/// less noise it has; the line goes on from the newest.
void clock_line::fit() {
  auto first = points_.size() - 1;
  const auto wanted = span_wanted();
  while (first > 0 && points_.back().own - points_[first].own < wanted)
    --first;
  const std::span<const point> used(points_.begin() + static_cast<std::ptrdiff_t>(first),
                                    points_.end());
  const auto least = noise_of(std::ranges::min_element(used, {}, &point::noise)->noise);
  fit_middle(used, least);
  const auto span = used.back().own - used.front().own;
  const bool tells_rate = span >= span_min;
  if (tells_rate)
    fit_slope(used, least);
  auto worst = missed(used.back());
  for (const auto& x : used)
    worst = std::max(worst, least / noise_of(x.noise) * missed(x));
  noise_ += rounded_up(worst);
  const auto noise = std::max(worst, static_cast<double>(fit_noise.count()));
  if (tells_rate)
    slope_doubt_ = std::min(std::max(slope_doubt_, 2 * noise * 1e-6 / seconds(span)), rate_max);
}

void clock_line::fit_middle(std::span<const point> used, double least) {
  const auto& origin = used.front();
  double weights = 0;
  double sum_own = 0;
  double sum_ahead = 0;
  for (const auto& x : used) {
    const auto weight = weight_of(x.noise, least);
    weights += weight;
    sum_own += weight * static_cast<double>(us_of(x.own) - us_of(origin.own));
    sum_ahead += weight * static_cast<double>(x.ahead_us - origin.ahead_us);
  }
  const auto mean_own = std::floor(sum_own / weights);
  middle_ = origin.own + microseconds(static_cast<std::int64_t>(mean_own));
  middle_ahead_us_ = static_cast<double>(origin.ahead_us) + sum_ahead / weights;
}

void clock_line::fit_slope(std::span<const point> used, double least) {
  lever all;
  for (const auto& x : used)
    all.add(weight_of(x.noise, least), static_cast<double>(us_of(x.own) - us_of(middle_)),
            static_cast<double>(x.ahead_us) - middle_ahead_us_, noise_of(x.noise));
  slope_ = std::clamp(all.slope(), -rate_max, rate_max);
  slope_doubt_ = all.slope_doubt();
  lag_ = seconds(used.back().own - middle_) - all.slope_at() * 1e-6;
}

double clock_line::missed(const point& x) const {
  return static_cast<double>(std::abs(x.ahead_us - ahead_us(x.own)));
}

microseconds clock_line::doubt(instant x) const {
  assert(!empty());
  const auto since = seconds(std::chrono::abs(x - points_.back().own));
  const bool knows_rate = slope_doubt_ < rate_max;
  const auto of_rate = since * slope_doubt_ * 1e6 + wander() * missed_by_wander(since);
  const auto most = since * (rate_max + std::abs(slope_)) * 1e6; // the rate is the other extreme
  return noise_ + rounded_up(knows_rate ? std::min(of_rate, most) : most);
}

duration clock_line::lasts(microseconds limit) const {
  if (wander_seen_ <= 0)
    return duration::max();
  const auto area = static_cast<double>(limit.count()) * 1e-6 / wander_seen_; // a margin of two
  const auto length = std::sqrt(lag_ * lag_ + area) - lag_;
  return duration(static_cast<duration::rep>(length * 1e9));
}

std::int64_t clock_line::ahead_us(instant x) const {
  const auto from_middle = static_cast<double>(us_of(x) - us_of(middle_));
  return static_cast<std::int64_t>(std::floor(middle_ahead_us_ + slope_ * from_middle + 0.5));
}

island_time clock_line::at(instant x) const {
  return island_time(microseconds(us_of(x) + ahead_us(x)));
}

/// The line is so flat that one correction comes within a microsecond or two.
instant clock_line::when(island_time x) const {
  const auto about = instant(x.time_since_epoch() - microseconds(ahead_us(middle_)));
  auto found = instant(x.time_since_epoch() - microseconds(ahead_us(about)));
  while (at(found) < x)
    found += microseconds{1};
  while (at(found - microseconds{1}) >= x)
    found -= microseconds{1};
  return found;
}

} // namespace rubicon::network
