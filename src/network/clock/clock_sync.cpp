#include "network/clock/clock_sync.hpp"

#include <algorithm>
#include <cassert>

#include "core/network_time.hpp"

namespace rubicon::network {

namespace {

using std::chrono::microseconds;

constexpr std::uint16_t rounds_missed_max = 64; ///< in a row
constexpr microseconds leap_min{1000};          ///< of the network time: sent at once
constexpr microseconds hop_noise{15};   ///< of a stamp: clocks are read to a microsecond or so
constexpr microseconds better_min{200}; ///< who is less in doubt needs no other's stamp
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

/// Of a point of a round that is known.
stamp_value value_of(point_fate x) {
  switch (x) {
  case point_fate::taken:
    break;
  case point_fate::disputed:
    return stamp_value::in_dispute;
  case point_fate::restarted:
    return stamp_value::leap;
  }
  return stamp_value::point;
}

} // namespace

clock_sync::clock_sync(clock_sync_config config, instant now)
    : config_(config),
      rounds_(config.is_root ? round_schedule(config, now) : round_schedule(config)) {
  if (!config_.is_root)
    return;
  root_ = config_.self;
  era_ = config_.era;
  time_.ticks().learn(config_.tick);
}

stamp_value clock_sync::on_stamp(const clock_stamp& x, instant sfd) {
  if (x.root == mote_id{} || x.doubt == doubt_asks)
    return stamp_value::outdated;
  if (x.tick.period.count() == 0 || (config_.is_root && x.root != config_.self))
    return stamp_value::none;
  const clock_point here{sfd, x.time.time_since_epoch().count() + x.age_us - us_of(sfd),
                         limit_of(x.doubt) + hop_noise};
  return time_.is_own() ? judge_by_root(x, here, sfd) : judge(x, here);
}

/// The root's time is right by definition, but a mote that has another needs to know.
stamp_value clock_sync::judge_by_root(const clock_stamp& x, const clock_point& here, instant sfd) {
  if (is_newer_era(x.era, era_)) { // we do not remember it
    era_ = x.era;
    begin_era(time_.at(sfd), sfd);
    return stamp_value::outdated;
  }
  if (x.era == era_ && is_ahead(x.sequence, sequence_)) {
    sequence_ = x.sequence;
    rounds_.restart(sfd);
  }
  if (x.era == era_ && time_.fits(here))
    return stamp_value::none;
  rounds_.restart_for_dispute(sfd);
  return stamp_value::outdated;
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
         (!time_.synchronised() || 2 * (limit_of(x.doubt) + hop_noise) < time_.line().doubt(sfd));
}

stamp_value clock_sync::judge_news(const clock_stamp& x, const clock_point& here) {
  const bool is_stale_now = is_stale(here.own);
  const bool is_believed = is_stale_now || x.root != root_ || x.era != era_;
  if (x.root != root_)
    time_.forget();
  const auto fate = time_.take(
      here,
      {.is_news = true, .is_believed = is_believed, .has_leapt = is_believed && !is_stale_now});
  if (fate == point_fate::disputed)
    return stamp_value::in_dispute;
  take_news(x, here.own);
  if (fate == point_fate::restarted) {
    time_.ticks().replace(x.tick);
    return stamp_value::leap;
  }
  time_.ticks().learn(x.tick);
  return stamp_value::news;
}

stamp_value clock_sync::judge(const clock_stamp& x, const clock_point& here) {
  const auto sfd = here.own;
  if (is_news(x, sfd))
    return judge_news(x, here);
  if (x.root != root_ || !time_.synchronised())
    return stamp_value::none;
  if (x.era != era_)
    return stamp_value::outdated;
  const auto ours = time_.line().doubt(sfd);
  const bool is_sure = here.doubt <= std::max<microseconds>(ours, 2 * time_estimate::outlier);
  if (is_sure && time_.is_disputed())
    return value_of(time_.take(here, {.is_believed = time_.is_distrusted()}));
  if (!time_.fits(here))
    return here.doubt < ours && is_of_last_round(x) ? value_of(time_.take(here, {}))
                                                    : stamp_value::outdated;
  if (is_of_last_round(x) && ours > better_min && 2 * here.doubt < ours)
    return value_of(time_.take(here, {}));
  return stamp_value::none;
}

void clock_sync::take_news(const clock_stamp& x, instant sfd) {
  news_ = sfd;
  root_ = x.root;
  era_ = x.era;
  sequence_ = x.sequence;
  time_.use_slots(x.slots_used);
  constexpr auto ahead_max = in_us(network_time_end); // more is nonsense
  const bool is_sane = x.network && x.network->ahead > -ahead_max && x.network->ahead < ahead_max;
  time_.set_network({is_sane ? x.network : std::nullopt, x.time});
  rounds_.on_answer(sfd);
}

bool clock_sync::is_trusted(instant now) const {
  if (config_.is_root)
    return time_.is_own();
  return time_.synchronised() && !time_.is_disputed() && !is_stale(now);
}

std::optional<clock_stamp> clock_sync::stamp(instant now) const {
  if (!time_.synchronised())
    return std::nullopt;
  clock_stamp x;
  x.root = root_;
  x.era = era_;
  x.sequence = sequence_;
  x.time = time_.at(now);
  x.tick = time_.ticks().newest();
  x.slots_used = time_.slots_used();
  x.doubt = time_.is_own() ? std::uint8_t{0} : doubt_of(time_.doubt(now));
  x.network = time_.network().at(x.time);
  return x;
}

// The root's rounds.

bool clock_sync::on_time(instant now) {
  if (!rounds_.is_due(now))
    return false;
  if (rounds_.is_listening())
    resume(now);
  else if (const auto time = time_.at(now);
           time < island_time{} || time.time_since_epoch() > time_max)
    begin_era(island_time{}, now); // no stamp can say this
  ++sequence_;
  const auto here = time_.at(now);
  if (const auto line = time_.network().at(here))
    announced_ = {line, here};
  rounds_.advance(now);
  return true;
}

/// The time goes on, at our own pace, or begins.
void clock_sync::resume(instant now) {
  const auto time = time_.synchronised() ? time_.at(now) : island_time{};
  if (is_newer_era(config_.era, era_))
    era_ = config_.era;
  rounds_.stop_listening();
  begin_era(time, now);
  if (reference_)
    set_network_time(reference_->since_1970 + (now - reference_->own), reference_->rate, now);
}

/// Motes that learn of it take the time of it at once.
void clock_sync::begin_era(island_time x, instant now) {
  const auto by = x - time_.at(now);
  const bool goes_on = std::chrono::abs(by) <= microseconds{1};
  if (!goes_on && sequence_ != 0) {
    time_.ticks().move(by);
    time_.set_network({});
    announced_ = {};
  }
  ++era_;
  time_.set(x, now);
  rounds_.restart(now);
}

void clock_sync::set_time(island_time x, instant now) {
  assert(config_.is_root);
  rounds_.stop_listening();
  begin_era(x, now);
}

std::optional<duration> clock_sync::wanted_period() const {
  if (config_.is_root || time_.line().empty())
    return std::nullopt;
  const auto wanted = time_.line().lasts(promised);
  if (wanted >= config_.period)
    return std::nullopt;
  return std::max(wanted, config_.period_least);
}

void clock_sync::request_period(duration x, instant now) {
  assert(config_.is_root);
  rounds_.request(x, now);
}

void clock_sync::use_slots(std::uint8_t sevenths, instant now) {
  assert(config_.is_root);
  if (time_.slots_used() == sevenths)
    return;
  time_.use_slots(sevenths);
  rounds_.restart(now);
}

void clock_sync::set_network_time(duration since_1970, double rate, instant now) {
  assert(config_.is_root);
  if (!time_.is_own()) {
    reference_ = {since_1970, rate, now};
    return;
  }
  const auto here = time_.at(now);
  const network_line line{std::chrono::floor<microseconds>(since_1970) - here.time_since_epoch(),
                          rate};
  time_.set_network({line, here});
  const auto expected = announced_.at(here);
  if (!expected || std::chrono::abs(line.ahead - expected->ahead) > leap_min) {
    announced_ = {line, here};
    rounds_.restart(now);
  }
}

void clock_sync::set_tick(const tick_setting& x, instant now) {
  assert(config_.is_root);
  time_.ticks().learn(x);
  rounds_.restart(now);
}

} // namespace rubicon::network
