#include "network/clock/time_reference.hpp"

#include <algorithm>
#include <cmath>

namespace rubicon::network {

time_reference::time_reference(time_reference_config config, instant now)
    : config_(config), next_(now + config.gap_first) {}

std::optional<std::uint16_t> time_reference::on_time(instant now) {
  if (now < next_)
    return std::nullopt;
  ++counters_.asked;
  next_ = now + (counters_.asked < config_.first ? config_.gap_first : config_.gap);
  asked_ = now;
  return ++number_;
}

void time_reference::on_delayed(duration by) {
  if (asked_)
    *asked_ += by;
}

void time_reference::on_answer(std::uint16_t number, duration since_1970, instant now,
                               duration held) {
  if (!asked_ || number != number_) {
    ++counters_.strays;
    return;
  }
  ++counters_.answered;
  const auto sent = *asked_;
  asked_.reset();
  const auto round_trip = now - sent - held;
  const answer x{sent + round_trip / 2, since_1970 - (sent + round_trip / 2).time_since_epoch(),
                 round_trip};
  if (!is_good(round_trip)) {
    ++counters_.slow;
    ask_again(now);
    return;
  }
  if (!agrees(x)) {
    ask_again(now);
    return;
  }
  ++counters_.good;
  repeats_ = 0;
  const auto count = answers_.size();
  if (count >= answers_max / 2 &&
      answers_[count - 1].own - answers_[count - 2].own < config_.spread)
    answers_.pop_back();
  answers_.push_back(x);
  if (answers_.size() > answers_max)
    answers_.pop_front();
  fit();
  if (answers_.size() < config_.first)
    next_ = std::min(next_, now + config_.gap_first);
}

bool time_reference::is_good(duration round_trip) {
  if (round_trip < 0s || round_trip > config_.answer_max)
    return false; // or who answers is wrong about its line
  round_trips_.push_back(round_trip);
  if (round_trips_.size() > answers_max)
    round_trips_.pop_front();
  return round_trip <= *std::ranges::min_element(round_trips_) + config_.excess_max;
}

/// Whether an answer belongs to the line; begins a new one if it agrees with the one before.
bool time_reference::agrees(const answer& x) {
  const auto is_near = [this](duration a, duration b, double off) {
    return seconds(std::chrono::abs(a - b)) <= seconds(config_.leap_min) + off;
  };
  if (!answers_.empty() && x.round_trip + config_.excess_max < shortest_good()) {
    answers_.clear(); // all had waited in queues, as is seen now
    doubtful_.reset();
    return true;
  }
  const auto drifted = has_drift_ ? 0 : config_.drift_max * seconds(x.own - middle_);
  if (answers_.empty() || is_near(x.ahead, ahead(x.own), drifted)) {
    doubtful_.reset();
    return true;
  }
  if (doubtful_ && is_near(x.ahead, doubtful_->ahead, 0)) {
    answers_.assign(1, *doubtful_);
    doubtful_.reset();
    --counters_.doubtful;
    ++counters_.good;
    ++counters_.leaps;
    return true;
  }
  ++counters_.doubtful;
  doubtful_ = x;
  return false;
}

duration time_reference::shortest_good() const {
  return std::ranges::min_element(answers_, {}, &answer::round_trip)->round_trip;
}

void time_reference::ask_again(instant now) {
  if (++repeats_ <= config_.repeats_max)
    next_ = std::min(next_, now + config_.gap_first);
  else
    repeats_ = 0;
}

void time_reference::fit() {
  const auto shortest = shortest_good();
  std::deque<answer> good;
  std::ranges::copy_if(answers_, std::back_inserter(good), [&](const answer& x) {
    return x.round_trip <= shortest + config_.excess_max;
  });
  const auto count = static_cast<duration::rep>(good.size());
  const auto first = good.front();
  duration own{};
  duration more{};
  for (const auto& x : good) {
    own += x.own - first.own;
    more += x.ahead - first.ahead;
  }
  middle_ = first.own + own / count;
  middle_ahead_ = first.ahead + more / count;
  if (good.back().own - first.own < config_.span_min)
    return;
  double covariance = 0;
  double variance = 0;
  for (const auto& x : good) {
    const auto t = seconds(x.own - middle_);
    covariance += t * seconds(x.ahead - middle_ahead_);
    variance += t * t;
  }
  has_drift_ = true;
  drift_ = std::clamp(covariance / variance, -config_.drift_max, config_.drift_max);
}

duration time_reference::ahead(instant own) const {
  const auto since = static_cast<double>((own - middle_).count());
  return middle_ahead_ + duration(static_cast<duration::rep>(std::floor(drift_ * since + 0.5)));
}

/// What it takes its own clock for is ahead by so much until answers show that it is not.
void time_reference::on_clock_leapt(duration by) {
  for (auto& x : answers_)
    x.ahead += by;
  if (doubtful_)
    doubtful_->ahead += by;
  middle_ahead_ += by;
}

std::optional<duration> time_reference::at(instant own) const {
  if (answers_.empty())
    return std::nullopt;
  return own.time_since_epoch() + ahead(own);
}

} // namespace rubicon::network
