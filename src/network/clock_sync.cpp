#include "network/clock_sync.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <utility>

#include "network/wire.hpp"

namespace rubicon::network {

namespace {

using std::chrono::microseconds;

constexpr unsigned period_bits = 13;
constexpr std::uint16_t rounds_missed_max = 64; ///< in a row
constexpr unsigned behind_max = 4;              ///< rounds of a root that has begun anew
constexpr microseconds tells_network_time{std::int64_t{1} << 47}; ///< added to tick.from
constexpr microseconds leap_min{1000};                  ///< of the network time: told at once
constexpr microseconds network_ahead_max = 24h * 36525; ///< more is nonsense
constexpr double doubt_steps = 8;                       ///< in which a doubt doubles, in a stamp
constexpr microseconds hop_noise{15};   ///< of a stamp: clocks are read to a microsecond or so
constexpr microseconds fit_noise{30};   ///< of a point of the line, at least
constexpr microseconds better_min{200}; ///< who is less in doubt needs no other's word
constexpr duration span_min = 3s;       ///< of points that tell a rate,
constexpr duration span_good = 5min;    ///< and of those that tell it well: older ones are not used
constexpr duration wander_gap = 30s;    ///< between points that show whether the rate changes
constexpr double wander_min = 1e-6;     ///< a crystal's rate changes so much between two rounds
constexpr double wander_kept = 0.8;     ///< of what was seen of that, at each point
constexpr double rate_unit = 1e-8;      ///< of the network time, in a stamp

/// Whether a round can have followed another.
bool is_ahead(std::uint16_t sequence, std::uint16_t other) {
  const auto rounds = static_cast<std::uint16_t>(sequence - other);
  return rounds > 0 && rounds <= rounds_missed_max;
}

std::int64_t us_of(instant x) {
  return std::chrono::floor<microseconds>(x.time_since_epoch()).count();
}

/// How a line goes on from one time to another.
network_line moved(network_line x, microseconds by) {
  x.ahead += microseconds(
      static_cast<std::int64_t>(std::floor(x.rate * static_cast<double>(by.count()) + 0.5)));
  return x;
}

} // namespace

std::uint8_t doubt_of(microseconds x) {
  if (x <= microseconds{0})
    return 0;
  const auto code = std::ceil(doubt_steps * std::log2(static_cast<double>(x.count())));
  return static_cast<std::uint8_t>(std::clamp(code, 1.0, 255.0));
}

microseconds limit_of(std::uint8_t doubt) {
  if (doubt == 0)
    return microseconds{0};
  return microseconds(static_cast<std::int64_t>(std::ceil(std::exp2(doubt / doubt_steps))));
}

void write(byte_writer& to, const clock_stamp& x) {
  to.big(x.root.value).big(x.sequence);
  assert(x.tick.from >= island_time{} && x.tick.from.time_since_epoch() < tells_network_time);
  write(to, x.time);
  to.big(x.age_us).big(x.tick.first);
  write(to, x.network ? x.tick.from + tells_network_time : x.tick.from);
  to.big(static_cast<std::uint16_t>(x.tick.period.count() | x.slots_used << period_bits));
  to.octet(x.doubt);
  if (x.network) {
    const auto rate = std::clamp(std::floor(x.network->rate / rate_unit + 0.5), -32768.0, 32767.0);
    to.big(static_cast<std::uint64_t>(x.network->ahead.count()));
    to.big(static_cast<std::uint16_t>(static_cast<std::int16_t>(rate)));
  }
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
  x.doubt = from.octet();
  if (x.tick.from.time_since_epoch() >= tells_network_time) {
    x.tick.from -= tells_network_time;
    network_line line;
    line.ahead = microseconds(static_cast<std::int64_t>(from.big<std::uint64_t>()));
    line.rate = static_cast<std::int16_t>(from.big<std::uint16_t>()) * rate_unit;
    x.network = line;
  }
  return x;
}

clock_sync::clock_sync(clock_sync_config config, instant now)
    : config_(config), gap_(config.period_first) {
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
///
/// A number far behind that counts on is news too: a root that has begun anew does so, no circle of
/// old news does.
bool clock_sync::is_news(const clock_stamp& x, instant sfd) {
  if (!heard_)
    return true;
  if (sfd - *heard_ > config_.stale_after)
    return x.root != root_ || x.sequence != sequence_;
  if (x.root != root_)
    return false;
  if (is_ahead(x.sequence, sequence_))
    return true;
  if (x.sequence == sequence_ || !is_ahead(x.sequence, behind_))
    behind_count_ = x.sequence == behind_ ? behind_count_ : 0;
  else
    ++behind_count_;
  behind_ = x.sequence;
  return behind_count_ >= behind_max;
}

/// Whether who says this knows the time much better than we do.
bool clock_sync::is_better(const clock_stamp& x, instant sfd) const {
  const auto ours = points_.empty() ? microseconds::max() : doubt(sfd);
  return is_of_last_round(x) && ours > better_min && 2 * (limit_of(x.doubt) + hop_noise) < ours;
}

bool clock_sync::on_stamp(const clock_stamp& x, instant sfd) {
  if (x.tick.period.count() == 0 || (config_.is_root && x.root != config_.self))
    return false;
  if (is_running_root()) { // others have heard of rounds of ours that we do not know of
    if (is_ahead(x.sequence, sequence_)) {
      sequence_ = x.sequence;
      start_rounds(sfd);
    }
    return false;
  }
  if (!is_news(x, sfd)) {
    if (is_better(x, sfd))
      add_point(x, sfd);
    return false;
  }
  if (x.root != root_) { // another time, by a crystal that we know nothing of
    steps_ += points_.empty() ? 0 : 1;
    points_.clear();
    doubtful_.reset();
    slope_ = 0;
    slope_doubt_ = rate_max;
  }
  root_ = x.root;
  if (!add_point(x, sfd))
    return false;
  heard_ = sfd;
  sequence_ = x.sequence;
  behind_count_ = 0;
  learn(x.tick);
  slots_used_ = x.slots_used;
  const bool is_sane =
      x.network && x.network->ahead >= -network_ahead_max && x.network->ahead <= network_ahead_max;
  network_ = is_sane ? x.network : std::nullopt;
  network_from_ = x.time;
  return true;
}

/// @returns whether it was taken, and not ignored
bool clock_sync::add_point(const clock_stamp& x, instant sfd) {
  const point here{sfd, x.time.time_since_epoch().count() + x.age_us - us_of(sfd), x.sequence};
  const auto told = limit_of(x.doubt) + hop_noise;
  const auto is_near = [](std::int64_t a, std::int64_t b, microseconds limit) {
    return std::abs(a - b) <= limit.count();
  };
  if (!points_.empty() && !is_near(here.ahead_us, ahead_us(sfd), outlier + told + doubt(sfd))) {
    const auto apart = doubtful_ ? seconds(sfd - doubtful_->own) * rate_max : 0.0;
    const auto limit = outlier + told + microseconds(static_cast<std::int64_t>(apart * 1e6));
    if (doubtful_ && doubtful_->sequence == here.sequence)
      return false;
    if (!doubtful_ || !is_near(here.ahead_us, doubtful_->ahead_us, limit)) {
      doubtful_ = here;
      return false;
    }
    points_.assign(1, *doubtful_);
    ++steps_;
  } else {
    learn_wander(here);
  }
  doubtful_.reset();
  points_.push_back(here);
  if (points_.size() > points_max)
    points_.erase(points_.begin());
  point_doubt_ = told;
  fit();
  return true;
}

/// What the line has missed a point by, beyond its noise, in the time since the one before.
void clock_sync::learn_wander(const point& x) {
  if (points_.empty() || slope_doubt_ >= rate_max)
    return;
  const auto since = x.own - points_.back().own;
  if (since < wander_gap)
    return;
  const auto missed = static_cast<double>(std::abs(x.ahead_us - ahead_us(x.own)));
  const auto noise = static_cast<double>((fit_noise + point_doubt_).count());
  const auto seen = std::max(missed - noise, 0.0) * 1e-6 / seconds(since);
  wander_ = std::min(std::max(wander_kept * wander_, seen), rate_max);
}

/// Least squares through the newest points that span long enough; the line goes on from the newest.
void clock_sync::fit() {
  auto first = points_.size() - 1;
  while (first > 0 && points_.back().own - points_[first].own < span_good)
    --first;
  const std::span used(points_.begin() + static_cast<std::ptrdiff_t>(first), points_.end());
  const auto count = static_cast<double>(used.size());
  double sum_own = 0;
  double sum_ahead = 0;
  for (const auto& x : used) {
    sum_own += static_cast<double>(us_of(x.own) - us_of(used.front().own));
    sum_ahead += static_cast<double>(x.ahead_us - used.front().ahead_us);
  }
  const auto mean_own = std::floor(sum_own / count);
  middle_ = used.front().own + microseconds(static_cast<std::int64_t>(mean_own));
  middle_ahead_us_ = static_cast<double>(used.front().ahead_us) + sum_ahead / count;
  const auto span = used.back().own - used.front().own;
  const bool tells_rate = span >= span_min;
  double covariance = 0;
  double variance = 0;
  for (const auto& x : used) {
    const auto own = static_cast<double>(us_of(x.own) - us_of(middle_));
    covariance += own * (static_cast<double>(x.ahead_us) - middle_ahead_us_);
    variance += own * own;
  }
  if (tells_rate)
    slope_ = std::clamp(covariance / variance, -rate_max, rate_max);
  double worst = 0;
  for (const auto& x : used)
    worst = std::max(worst, std::abs(static_cast<double>(x.ahead_us - ahead_us(x.own))));
  point_doubt_ += microseconds(static_cast<std::int64_t>(worst));
  const auto noise = std::max(worst, static_cast<double>(fit_noise.count()));
  if (tells_rate)
    slope_doubt_ = std::min(2 * noise * 1e-6 / seconds(span), rate_max);
  else if (points_.size() == 1)
    slope_doubt_ = rate_max;
}

microseconds clock_sync::doubt(instant x) const {
  assert(synchronised());
  if (is_running_root())
    return microseconds{0};
  const auto since = seconds(std::chrono::abs(x - points_.back().own));
  const auto rate = std::min(slope_doubt_ + std::max(wander_, wander_min), rate_max);
  return point_doubt_ + microseconds(static_cast<std::int64_t>(std::ceil(since * rate * 1e6)));
}

std::int64_t clock_sync::ahead_us(instant x) const {
  const auto from_middle = static_cast<double>(us_of(x) - us_of(middle_));
  return static_cast<std::int64_t>(std::floor(middle_ahead_us_ + slope_ * from_middle + 0.5));
}

island_time clock_sync::at(instant x) const {
  assert(synchronised());
  return island_time(microseconds(us_of(x) + ahead_us(x)));
}

/// The line is so flat that one correction comes within a microsecond or two.
instant clock_sync::when(island_time x) const {
  assert(synchronised());
  const auto about = instant(x.time_since_epoch() - microseconds(ahead_us(middle_)));
  auto found = instant(x.time_since_epoch() - microseconds(ahead_us(about)));
  while (at(found) < x)
    found += microseconds{1};
  while (at(found - microseconds{1}) >= x)
    found -= microseconds{1};
  return found;
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
                     is_running_root() ? std::uint8_t{0} : doubt_of(doubt(now)),
                     network_at(at(now))};
}

bool clock_sync::on_time(instant now) {
  if (!next_round_ || now < *next_round_)
    return false;
  if (listening_until_) { // the time goes on, at our own pace, or begins
    const auto time = points_.empty() ? island_time{} : at(now);
    listening_until_.reset();
    set_time(time, now);
    if (reference_) {
      const auto& [since_1970, rate, then] = *reference_;
      set_network_time(since_1970 + (now - then), rate, now);
    }
  }
  ++sequence_;
  if (++rounds_ > config_.first_rounds)
    gap_ = std::min(2 * gap_, config_.period);
  if (const auto line = network_at(at(now))) {
    has_told_network_ = true;
    told_network_ = *line;
    told_network_from_ = at(now);
  }
  next_round_ = now + gap_;
  return true;
}

/// A round begins at once, and others follow soon: who misses one hears another.
void clock_sync::start_rounds(instant now) {
  rounds_ = 0;
  gap_ = config_.period_first;
  if (is_running_root())
    next_round_ = now;
}

void clock_sync::set_tick(const tick_setting& x, instant now) {
  assert(config_.is_root);
  learn(x);
  start_rounds(now);
}

void clock_sync::use_slots(std::uint8_t sevenths, instant now) {
  assert(config_.is_root);
  if (std::exchange(slots_used_, sevenths) != sevenths)
    start_rounds(now);
}

void clock_sync::set_network_time(duration since_1970, double rate, instant now) {
  assert(config_.is_root);
  if (!is_running_root()) {
    reference_ = {since_1970, rate, now};
    return;
  }
  const auto here = at(now);
  network_ =
      network_line{std::chrono::floor<microseconds>(since_1970) - here.time_since_epoch(), rate};
  network_from_ = here;
  const auto expected = moved(told_network_, here - told_network_from_).ahead;
  if (!has_told_network_ || std::chrono::abs(network_->ahead - expected) > leap_min) {
    has_told_network_ = true;
    told_network_ = *network_;
    told_network_from_ = here;
    start_rounds(now);
  }
}

std::optional<network_line> clock_sync::network_at(island_time x) const {
  return network_ ? std::optional(moved(*network_, x - network_from_)) : std::nullopt;
}

std::optional<duration> clock_sync::network_time(instant x) const {
  if (!synchronised())
    return std::nullopt;
  const auto line = network_at(at(x));
  return line ? std::optional<duration>(at(x).time_since_epoch() + line->ahead) : std::nullopt;
}

void clock_sync::set_time(island_time x, instant now) {
  assert(config_.is_root);
  points_.clear();
  slope_ = 0;
  middle_ = now;
  middle_ahead_us_ = static_cast<double>(x.time_since_epoch().count() - us_of(now));
  start_rounds(now);
}

std::optional<tick_setting> clock_sync::tick(instant now) const {
  const bool has_changed = next_tick_ && synchronised() && at(now) >= next_tick_->from;
  const auto& told = has_changed ? next_tick_ : tick_;
  if (!told || !network_ || !synchronised())
    return told;
  const auto here = at(now);
  const auto time = here.time_since_epoch() + network_at(here)->ahead;
  const microseconds period = told->period;
  const auto number = period_number(time, period);
  return tick_setting{static_cast<std::uint32_t>(number), here - (time - number * period),
                      told->period};
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
