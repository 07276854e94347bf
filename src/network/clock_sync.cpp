#include "network/clock_sync.hpp"

#include <cassert>
#include <cmath>
#include <utility>

#include "network/wire.hpp"

namespace rubicon::network {

namespace {

using std::chrono::microseconds;

constexpr unsigned period_bits = 13;
constexpr int stale_periods = 3;                ///< without news of it: a root may have begun anew
constexpr std::uint16_t rounds_missed_max = 64; ///< far more than fit that time
constexpr microseconds tells_network_time{std::int64_t{1} << 47}; ///< added to tick.from
constexpr microseconds leap_min{1000};                  ///< of the network time: told at once
constexpr microseconds network_ahead_max = 24h * 36525; ///< more is nonsense

std::int64_t us_of(instant x) {
  return std::chrono::floor<microseconds>(x.time_since_epoch()).count();
}

} // namespace

void write(byte_writer& to, const clock_stamp& x) {
  to.big(x.root.value).big(x.sequence);
  assert(x.tick.from >= island_time{} && x.tick.from.time_since_epoch() < tells_network_time);
  write(to, x.time);
  to.big(x.age_us).big(x.tick.first);
  write(to, x.network_ahead ? x.tick.from + tells_network_time : x.tick.from);
  to.big(static_cast<std::uint16_t>(x.tick.period.count() | x.slots_used << period_bits));
  if (x.network_ahead)
    to.big(static_cast<std::uint64_t>(x.network_ahead->count()));
}

clock_stamp read_clock_stamp(byte_reader& from) {
  clock_stamp x;
  x.root = mote_id{from.big<std::uint16_t>()};
  x.sequence = from.big<std::uint16_t>();
  x.time = read_island_time(from);
  x.age_us = from.big<std::uint32_t>();
  x.tick.first = from.big<std::uint32_t>();
  x.tick.from = read_island_time(from);
  const auto period = from.big<std::uint16_t>();
  x.tick.period = std::chrono::milliseconds(period & ((1U << period_bits) - 1));
  x.slots_used = static_cast<std::uint8_t>(period >> period_bits);
  if (x.tick.from.time_since_epoch() >= tells_network_time) {
    x.tick.from -= tells_network_time;
    x.network_ahead = microseconds(static_cast<std::int64_t>(from.big<std::uint64_t>()));
  }
  return x;
}

clock_sync::clock_sync(clock_sync_config config, instant now) : config_(config) {
  if (!config_.is_root)
    return;
  root_ = config_.self;
  learn(config_.tick);
  listening_until_ = now + config_.resume_wait;
  next_round_ = listening_until_;
}

/// While we hear of our root's rounds, the next ones are news, and nothing else: neither another
/// root nor a number that it cannot have reached. When we do not, anything but what we have is:
/// else those who believed in such a number would keep each other believing.
bool clock_sync::is_news(const clock_stamp& x, instant sfd) const {
  if (!heard_)
    return true;
  if (sfd - *heard_ > stale_periods * config_.period)
    return x.root != root_ || x.sequence != sequence_;
  const auto rounds = static_cast<std::uint16_t>(x.sequence - sequence_);
  return x.root == root_ && rounds > 0 && rounds <= rounds_missed_max;
}

bool clock_sync::on_stamp(const clock_stamp& x, instant sfd) {
  if (is_running_root() || x.tick.period.count() == 0)
    return false;
  if (config_.is_root && x.root != config_.self)
    return false;
  if (!is_news(x, sfd))
    return false;
  heard_ = sfd;
  root_ = x.root;
  sequence_ = x.sequence;
  learn(x.tick);
  slots_used_ = x.slots_used;
  const point here{sfd, x.time.time_since_epoch().count() + x.age_us - us_of(sfd)};
  const auto is_near = [](std::int64_t a, std::int64_t b) {
    return std::abs(a - b) <= outlier.count();
  };
  if (!points_.empty() && !is_near(here.ahead_us, ahead_us(sfd))) {
    if (!doubtful_ || !is_near(here.ahead_us, doubtful_->ahead_us)) {
      doubtful_ = here;
      return true;
    }
    points_.assign(1, *doubtful_);
    ++steps_;
  }
  doubtful_.reset();
  const bool is_sane = x.network_ahead && *x.network_ahead >= -network_ahead_max &&
                       *x.network_ahead <= network_ahead_max;
  network_ahead_ = is_sane ? x.network_ahead : std::nullopt;
  points_.push_back(here);
  if (points_.size() > points_max)
    points_.erase(points_.begin());
  fit();
  return true;
}

void clock_sync::fit() {
  const auto count = static_cast<double>(points_.size());
  const auto first = points_.front();
  double sum_own = 0;
  double sum_ahead = 0;
  for (const auto& x : points_) {
    sum_own += static_cast<double>(us_of(x.own) - us_of(first.own));
    sum_ahead += static_cast<double>(x.ahead_us - first.ahead_us);
  }
  const auto mean_own = std::floor(sum_own / count);
  middle_ = first.own + microseconds(static_cast<std::int64_t>(mean_own));
  middle_ahead_us_ = static_cast<double>(first.ahead_us) + sum_ahead / count;
  double covariance = 0;
  double variance = 0;
  for (const auto& x : points_) {
    const auto own = static_cast<double>(us_of(x.own) - us_of(middle_));
    covariance += own * (static_cast<double>(x.ahead_us) - middle_ahead_us_);
    variance += own * own;
  }
  slope_ = points_.size() > 1 && variance > 0 ? covariance / variance : slope_;
}

std::int64_t clock_sync::ahead_us(instant x) const {
  const auto from_middle = static_cast<double>(us_of(x) - us_of(middle_));
  return static_cast<std::int64_t>(std::floor(middle_ahead_us_ + slope_ * from_middle + 0.5));
}

island_time clock_sync::at(instant x) const {
  assert(synchronised());
  return island_time(microseconds(us_of(x) + ahead_us(x)));
}

/// The line is so flat that one correction suffices: drift squared is below a billionth.
instant clock_sync::when(island_time x) const {
  assert(synchronised());
  const auto about = instant(x.time_since_epoch() - microseconds(ahead_us(middle_)));
  return instant(x.time_since_epoch() - microseconds(ahead_us(about)));
}

std::optional<clock_stamp> clock_sync::stamp(instant now) const {
  if (!synchronised())
    return std::nullopt;
  return clock_stamp{root_,
                     sequence_,
                     at(now),
                     0,
                     next_tick_ ? *next_tick_ : tick_.value_or(tick_setting{}),
                     slots_used_,
                     network_ahead(now)};
}

bool clock_sync::on_time(instant now) {
  if (!next_round_ || now < *next_round_)
    return false;
  if (listening_until_ && !points_.empty())
    set_time(at(now), now); // the time goes on, at our own pace
  listening_until_.reset();
  ++sequence_;
  ++rounds_;
  next_round_ = now + (rounds_ < config_.first_rounds ? config_.period_first : config_.period);
  return true;
}

void clock_sync::use_slots(std::uint8_t sevenths, instant now) {
  assert(config_.is_root);
  if (std::exchange(slots_used_, sevenths) != sevenths && is_running_root())
    next_round_ = now;
}

void clock_sync::set_network_time(duration since_1970, instant now) {
  assert(config_.is_root);
  const auto ahead = std::chrono::floor<microseconds>(since_1970) - microseconds(us_of(now));
  const bool leaps =
      !network_ahead_own_ || std::chrono::abs(ahead - *network_ahead_own_) > leap_min;
  network_ahead_own_ = ahead;
  if (leaps && is_running_root())
    next_round_ = now;
}

std::optional<microseconds> clock_sync::network_ahead(instant x) const {
  if (!network_ahead_own_)
    return network_ahead_;
  return *network_ahead_own_ + (microseconds(us_of(x)) - at(x).time_since_epoch());
}

std::optional<duration> clock_sync::network_time(instant x) const {
  if (!synchronised())
    return std::nullopt;
  const auto ahead = network_ahead(x);
  return ahead ? std::optional<duration>(at(x).time_since_epoch() + *ahead) : std::nullopt;
}

void clock_sync::set_time(island_time x, instant now) {
  assert(config_.is_root);
  points_.clear();
  slope_ = 0;
  middle_ = now;
  middle_ahead_us_ = static_cast<double>(x.time_since_epoch().count() - us_of(now));
}

std::optional<tick_setting> clock_sync::tick(instant now) const {
  const bool has_changed = next_tick_ && synchronised() && at(now) >= next_tick_->from;
  return has_changed ? next_tick_ : tick_;
}

/// The newest round tells the newest setting, and the one before it only if that was never the
/// root's.
void clock_sync::learn(const tick_setting& x) {
  if (!tick_) {
    tick_ = x;
  } else if (x == *tick_) {
    next_tick_.reset();
  } else if (x != next_tick_) {
    if (next_tick_)
      tick_ = next_tick_;
    next_tick_ = x;
  }
}

} // namespace rubicon::network
