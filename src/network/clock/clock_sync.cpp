#include "network/clock/clock_sync.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace rubicon::network {

namespace {

using std::chrono::microseconds;

constexpr std::uint16_t rounds_missed_max = 64;         ///< in a row
constexpr microseconds leap_min{1000};                  ///< of the network time: sent at once
constexpr microseconds network_ahead_max = 24h * 36525; ///< more is nonsense
constexpr microseconds hop_noise{15};   ///< of a stamp: clocks are read to a microsecond or so
constexpr microseconds better_min{200}; ///< who is less in doubt needs no other's stamp
constexpr duration beacon_gap = 20ms;   ///< between two that are not the same one
constexpr duration dispute_gap = 10s;   ///< a root that is disputed repeats itself so often
constexpr microseconds time_max{std::int64_t{1} << 46}; ///< 2.2 years, within what a stamp holds

/// Whether a round can have followed another.
bool is_ahead(std::uint16_t sequence, std::uint16_t other) {
  const auto rounds = static_cast<std::uint16_t>(sequence - other);
  return rounds > 0 && rounds <= rounds_missed_max;
}

/// Serial number arithmetic (RFC 1982) on 8 bits.
bool is_newer_era(std::uint8_t a, std::uint8_t b) {
  return static_cast<std::int8_t>(static_cast<std::uint8_t>(a - b)) > 0;
}

/// How a line goes on from one time to another.
network_line moved(network_line x, microseconds by) {
  x.ahead += microseconds(
      static_cast<std::int64_t>(std::floor(x.rate * static_cast<double>(by.count()) + 0.5)));
  return x;
}

/// The same ticks where the time is another by `by`, told from the first one after zero on.
tick_setting moved(tick_setting x, microseconds by) {
  const auto from = x.from.time_since_epoch() + by;
  const auto ticks = period_number(from, x.period);
  x.from = island_time(from - ticks * microseconds(x.period));
  x.first = ticks > x.first ? 0 : static_cast<std::uint32_t>(x.first - ticks);
  return x;
}

} // namespace

clock_sync::clock_sync(clock_sync_config config, instant now)
    : config_(config), gap_(config.period_first), disputed_at_(now - dispute_gap) {
  if (!config_.is_root)
    return;
  root_ = config_.self;
  era_ = config_.era;
  learn(config_.tick);
  listening_until_ = now + config_.resume_wait;
  next_round_ = listening_until_;
}

stamp_value clock_sync::on_stamp(const clock_stamp& x, instant sfd) {
  if (x.root == mote_id{} || x.doubt == doubt_asks)
    return stamp_value::outdated;
  if (x.tick.period.count() == 0 || (config_.is_root && x.root != config_.self))
    return stamp_value::none;
  const clock_point here{sfd, x.time.time_since_epoch().count() + x.age_us - us_of(sfd),
                         limit_of(x.doubt) + hop_noise};
  return is_running_root() ? judge_by_root(x, here, sfd) : judge(x, here);
}

/// The root's time is right by definition, but a mote that has another needs to know.
stamp_value clock_sync::judge_by_root(const clock_stamp& x, const clock_point& here, instant sfd) {
  if (is_newer_era(x.era, era_)) { // we do not remember it
    era_ = x.era;
    begin_era(at(sfd), sfd);
    return stamp_value::outdated;
  }
  if (x.era == era_ && is_ahead(x.sequence, sequence_)) {
    sequence_ = x.sequence;
    start_rounds(sfd);
  }
  if (x.era == era_ && fits(here))
    return stamp_value::none;
  if (sfd - disputed_at_ >= dispute_gap) {
    disputed_at_ = sfd;
    start_rounds(sfd);
  }
  return stamp_value::outdated;
}

bool clock_sync::fits(const clock_point& x) const {
  const auto ours = is_running_root() ? microseconds{} : line_.doubt(x.own);
  return std::abs(x.ahead_us - line_.ahead_us(x.own)) <= (outlier + x.doubt + ours).count();
}

/// While rounds of our root come, the next ones are news, and nothing else: neither another root
/// nor a number that it cannot have reached. When none comes, so is what is much less in doubt than
/// we have become, as only somebody is who knows of newer ones: else those who believe in a number
/// that the root never had would keep each other believing.
bool clock_sync::is_news(const clock_stamp& x, instant sfd) const {
  if (!news_)
    return true;
  const bool is_stranger = x.root != root_;
  if (!is_stranger && x.era == era_ && is_ahead(x.sequence, sequence_))
    return true;
  if (!is_stranger && is_newer_era(x.era, era_))
    return true;
  return is_stale(sfd) && !is_of_last_round(x) &&
         (line_.empty() || 2 * (limit_of(x.doubt) + hop_noise) < line_.doubt(sfd));
}

stamp_value clock_sync::judge(const clock_stamp& x, const clock_point& here) {
  const auto sfd = here.own;
  if (is_news(x, sfd)) {
    const bool at_once = is_stale(sfd) || x.root != root_ || x.era != era_;
    if (x.root != root_ && !line_.empty()) { // another time, by a crystal that we know nothing of
      line_.clear();
      ++steps_;
    }
    const auto value = take_point(here, true, at_once);
    if (value == stamp_value::in_dispute)
      return value;
    take_news(x, sfd);
    if (value == stamp_value::leap) {
      tick_ = x.tick;
      next_tick_.reset();
      return value;
    }
    learn(x.tick);
    return stamp_value::news;
  }
  if (x.root != root_ || line_.empty())
    return stamp_value::none;
  if (x.era != era_)
    return stamp_value::outdated;
  const auto ours = line_.doubt(sfd);
  const bool is_sure = here.doubt <= std::max<microseconds>(ours, 2 * outlier);
  if (is_sure && (distrusted_ || disputed_))
    return take_point(here, false, distrusted_);
  if (!fits(here))
    return here.doubt < ours && is_of_last_round(x) ? take_point(here, false, false)
                                                    : stamp_value::outdated;
  if (is_of_last_round(x) && ours > better_min && 2 * here.doubt < ours)
    return take_point(here, false, false);
  return stamp_value::none;
}

/// @param at_once it is believed even if the line is far off
stamp_value clock_sync::take_point(const clock_point& here, bool is_news, bool at_once) {
  if (line_.empty()) {
    line_.restart(here.own, here.ahead_us, here.doubt);
    return stamp_value::point;
  }
  if (fits(here)) {
    disputed_.reset();
    distrusted_ = false;
    if (is_news || here.doubt <= line_.doubt(here.own))
      line_.add(here.own, here.ahead_us, here.doubt);
    return stamp_value::point;
  }
  const auto agrees = [&](const clock_point& y) {
    const auto apart = seconds(here.own - y.own) * clock_line::rate_max;
    const auto limit = outlier + here.doubt + y.doubt +
                       microseconds(static_cast<std::int64_t>(std::ceil(apart * 1e6)));
    return here.own - y.own >= beacon_gap && std::abs(here.ahead_us - y.ahead_us) <= limit.count();
  };
  if (!at_once && !(disputed_ && agrees(*disputed_))) {
    disputed_ = here;
    return stamp_value::in_dispute;
  }
  last_leap_ = microseconds(here.ahead_us - line_.ahead_us(here.own));
  if (is_news && at_once &&
      !is_stale(here.own)) // a new era: the root's time has leapt, not its rate
    line_.shift(last_leap_);
  line_.restart(here.own, here.ahead_us, here.doubt);
  disputed_.reset();
  distrusted_ = false;
  ++steps_;
  return stamp_value::leap;
}

void clock_sync::take_news(const clock_stamp& x, instant sfd) {
  news_ = sfd;
  root_ = x.root;
  era_ = x.era;
  sequence_ = x.sequence;
  slots_used_ = x.slots_used;
  const bool is_sane =
      x.network && x.network->ahead >= -network_ahead_max && x.network->ahead <= network_ahead_max;
  network_ = is_sane ? x.network : std::nullopt;
  network_from_ = x.time;
  if (listening_until_) { // what else there is comes soon
    listening_until_ = std::min(*listening_until_, sfd + config_.resume_more);
    next_round_ = listening_until_;
  }
}

bool clock_sync::is_trusted(instant now) const {
  if (config_.is_root)
    return is_running_root();
  return synchronised() && !disputed_ && !distrusted_ && !is_stale(now);
}

microseconds clock_sync::doubt(instant x) const {
  assert(synchronised());
  if (is_running_root())
    return microseconds{0};
  const auto off = disputed_ ? std::abs(disputed_->ahead_us - line_.ahead_us(disputed_->own)) : 0;
  return line_.doubt(x) + microseconds(off);
}

void clock_sync::on_clock_leapt(microseconds by) {
  line_.shift(by);
  if (disputed_)
    disputed_->ahead_us += by.count();
}

std::optional<clock_stamp> clock_sync::stamp(instant now) const {
  if (!synchronised())
    return std::nullopt;
  clock_stamp x;
  x.root = root_;
  x.era = era_;
  x.sequence = sequence_;
  x.time = at(now);
  x.tick = next_tick_ ? *next_tick_ : tick_.value_or(tick_setting{});
  x.slots_used = slots_used_;
  x.doubt = is_running_root() ? std::uint8_t{0} : doubt_of(doubt(now));
  x.network = network_at(x.time);
  return x;
}

// The root's rounds.

bool clock_sync::on_time(instant now) {
  if (!next_round_ || now < *next_round_)
    return false;
  if (listening_until_)
    resume(now);
  else if (at(now) < island_time{} || at(now).time_since_epoch() > time_max)
    begin_era(island_time{}, now); // no stamp can say this
  ++sequence_;
  auto longest = config_.period;
  if (requested_ && now < requested_until_)
    longest = std::clamp(*requested_, config_.period_least, longest);
  if (++rounds_ > config_.first_rounds)
    gap_ = std::min(2 * gap_, longest);
  if (const auto line = network_at(at(now))) {
    has_told_network_ = true;
    told_network_ = *line;
    told_network_from_ = at(now);
  }
  next_round_ = now + gap_;
  return true;
}

/// The time goes on, at our own pace, or begins.
void clock_sync::resume(instant now) {
  const auto time = line_.empty() ? island_time{} : at(now);
  if (is_newer_era(config_.era, era_))
    era_ = config_.era;
  listening_until_.reset();
  distrusted_ = false;
  disputed_.reset();
  begin_era(time, now);
  if (reference_) {
    const auto& [since_1970, rate, then] = *reference_;
    set_network_time(since_1970 + (now - then), rate, now);
  }
}

/// Motes that learn of it take the time of it at once.
void clock_sync::begin_era(island_time x, instant now) {
  const auto by = x - at(now);
  const bool goes_on = std::chrono::abs(by) <= microseconds{1};
  if (!goes_on && sequence_ != 0) {
    tick_ = moved(*tick_, by);
    if (next_tick_)
      next_tick_ = moved(*next_tick_, by);
    network_.reset();
    has_told_network_ = false;
  }
  ++era_;
  line_.set(now, x.time_since_epoch().count() - us_of(now));
  start_rounds(now);
}

void clock_sync::set_time(island_time x, instant now) {
  assert(config_.is_root);
  listening_until_.reset();
  begin_era(x, now);
}

/// A round begins at once, and others follow soon: who misses one receives another.
void clock_sync::start_rounds(instant now) {
  rounds_ = 0;
  gap_ = config_.period_first;
  if (is_running_root())
    next_round_ = now;
}

std::optional<duration> clock_sync::wanted_period() const {
  if (config_.is_root || line_.empty())
    return std::nullopt;
  const auto wanted = line_.lasts(promised);
  if (wanted >= config_.period)
    return std::nullopt;
  return std::max(wanted, config_.period_least);
}

void clock_sync::request_period(duration x, instant now) {
  assert(config_.is_root);
  const bool holds = requested_ && now < requested_until_;
  if (holds && *requested_ < x)
    return;
  requested_ = x;
  requested_until_ = now + config_.request_hold;
  if (!listening_until_ && next_round_)
    next_round_ = std::min(*next_round_, now + std::max(x, config_.period_least));
}

void clock_sync::use_slots(std::uint8_t sevenths, instant now) {
  assert(config_.is_root);
  if (std::exchange(slots_used_, sevenths) != sevenths)
    start_rounds(now);
}

// The time that peers share.

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

// Ticks.

void clock_sync::set_tick(const tick_setting& x, instant now) {
  assert(config_.is_root);
  learn(x);
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
