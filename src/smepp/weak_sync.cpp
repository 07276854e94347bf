#include "smepp/weak_sync.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "network/wire.hpp"

namespace rubicon::smepp {

namespace {

using std::chrono::microseconds;

constexpr std::uint8_t unsynchronised = 255; ///< hops of who needs the time
constexpr std::uint8_t hops_max = 254;

microseconds in_us(duration x) {
  return std::chrono::floor<microseconds>(x);
}

/// `x` scaled by a rate of some ppm: exact to a nanosecond for a day.
duration scaled(duration x, double rate) {
  return duration(std::llround(static_cast<double>(x.count()) * rate));
}

} // namespace

weak_sync::weak_sync(weak_sync_config config, random_stream rng, instant now)
    : config_(config), rng_(rng), newest_(now), followed_at_(now), hurried_(config.hurry_stamps),
      due_(now + rng_.between(duration{}, config.hurry_pause)) {}

void weak_sync::begin(instant now) {
  points_ = {{now, group_time{}}};
  is_timed_ = has_rate_ = true;
  root_ = config_.self;
  newest_ = now;
}

void weak_sync::adopt(group_time x, instant now) {
  points_ = {{now, x}};
  rate_ = 0;
  is_timed_ = has_rate_ = false;
  root_ = no_mote;
  newest_ = now;
}

group_time weak_sync::at(instant x) const {
  assert(is_known());
  const auto& last = points_.back();
  const auto since = x - last.own;
  return last.shared + in_us(since + scaled(since, rate_));
}

instant weak_sync::when(group_time x) const {
  assert(is_known());
  const auto& last = points_.back();
  const duration since = x - last.shared;
  return last.own + since - scaled(since, rate_ / (1 + rate_));
}

void weak_sync::stamp(sync_stamp& x, instant now) {
  x.of_last.reset();
  if (sent_at_ && has_rate_)
    x.of_last = at(*sent_at_);
  sent_at_.reset();
  if (is_root())
    ++round_;
  x.sequence = ++sequence_;
  x.now = at(now);
  x.root = root_ == no_mote ? config_.self : root_;
  x.round = round_;
  x.hops = has_rate_ ? hops_ : unsynchronised;
}

void weak_sync::on_stamp_sent(instant at) {
  sent_at_ = at;
}

std::optional<instant> weak_sync::reception_of(mote_id from, std::uint16_t sequence) const {
  const auto found = std::ranges::find(receptions_, from, &reception::from);
  if (found == receptions_.end() || found->sequence != sequence)
    return std::nullopt;
  return found->at;
}

void weak_sync::note(mote_id from, std::uint16_t sequence, instant at) {
  std::erase_if(receptions_, [&](const reception& x) { return x.from == from; });
  if (receptions_.size() >= receptions_max)
    receptions_.erase(receptions_.begin());
  receptions_.push_back({from, sequence, at});
}

bool weak_sync::is_wanted(const sync_stamp& x) const {
  if (x.root == gone_root_ && !network::is_newer(x.round, gone_round_))
    return false;
  if (!is_timed_)
    return true;
  if (x.root == root_ && !has_rate_) // what is older gives a rate as well, and is not from us
    return !network::is_newer(round_, x.round);
  if (x.root == root_)
    return !is_root() && network::is_newer(x.round, round_);
  return x.root < root_;
}

weak_sync::news weak_sync::take(const point& x, bool is_same_root) {
  const auto off = is_known() ? x.shared - at(x.own) : microseconds::max();
  const bool jumped = std::chrono::abs(off) > config_.jump;
  if (jumped || !is_timed_) {
    // Of the same root, the last two points make a better line than the one that has led so far
    // off.
    if (is_same_root && is_timed_)
      points_.erase(points_.begin(), points_.end() - 1);
    else
      points_.clear();
    if (jumped && is_timed_)
      hurry(x.own);
  }
  points_.push_back(x);
  if (points_.size() > points_max)
    points_.erase(points_.begin());
  const auto& first = points_.front();
  if (const auto span = x.own - first.own; span >= config_.span_min) {
    const duration shared = x.shared - first.shared;
    const auto slope =
        static_cast<double>((shared - span).count()) / static_cast<double>(span.count());
    rate_ = std::clamp(slope, -rate_max, rate_max);
    if (!has_rate_)
      hurry(x.own); // others wait for us
    has_rate_ = true;
  }
  is_timed_ = true;
  return jumped ? news::jumped : news::better;
}

weak_sync::news weak_sync::on_stamp(mote_id from, const sync_stamp& x, instant at) {
  const auto before = reception_of(from, static_cast<std::uint16_t>(x.sequence - 1));
  note(from, x.sequence, at);
  if (x.root == root_)
    followed_at_ = at;
  if (!has_rate_ && x.of_last) // its sender can give us the time
    newest_ = at;
  if (x.hops == unsynchronised && has_rate_ && at - helped_at_ >= config_.help_pause) {
    helped_at_ = at;
    hurry(at);
  }
  if (!is_known()) {
    adopt(x.now, at);
    return news::better;
  }
  if (!is_wanted(x))
    return news::none;
  if (!before || !x.of_last || *before > at) {
    if (x.root != root_)
      chase(at);
    return news::none;
  }
  chasing_until_ = at;
  const auto result = take({*before, *x.of_last}, x.root == root_);
  root_ = x.root;
  round_ = x.round;
  hops_ = static_cast<std::uint8_t>(std::min<int>(x.hops + 1, hops_max));
  newest_ = at;
  // We have been the root before we lost our memory: we are it again, and go on from there.
  if (root_ == config_.self)
    hops_ = 0;
  return result;
}

void weak_sync::hurry(instant now) {
  hurried_ = std::max(hurried_, config_.hurry_stamps);
  due_ = std::min(due_, now + rng_.between(duration{}, config_.hurry_pause));
}

bool weak_sync::on_time(instant now) {
  if (now < due_)
    return false;
  const auto pause = hurried_ > 0 ? config_.hurry_pause
                     : has_rate_  ? config_.period
                                  : 4 * config_.hurry_pause;
  if (hurried_ > 0)
    --hurried_;
  due_ = now + rng_.between(pause * 9 / 10, pause * 11 / 10);
  // Timeouts differ between members: the others receive the stamp of the first one.
  const auto limit = is_known() ? config_.root_timeout : config_.alone_timeout;
  const auto patience = limit + rng_.between(duration{}, limit / 2);
  if (!is_root() && now - newest_ > patience) {
    gone_root_ = root_;
    gone_round_ = round_;
    if (!is_known())
      begin(now);
    root_ = config_.self;
    hops_ = 0;
    is_timed_ = has_rate_ = true;
    newest_ = now;
  }
  return is_known();
}

} // namespace rubicon::smepp
