#include "traffic/schedule.hpp"

#include <algorithm>
#include <cassert>

#include "core/numbers/math.hpp"

namespace rubicon::traffic {

namespace {

constexpr double gap_max_ns = 0x1p62;

std::optional<instant> instant_of(std::optional<duration> x) {
  if (!x)
    return {};
  return instant(*x);
}

/// `at` + `x`, or the end of time.
instant later(instant at, duration x) {
  return at > instant::max() - x ? instant::max() : at + x;
}

} // namespace

schedule::schedule(const sender_config& config, random_stream rng)
    : pattern_(config.pattern), every_(config.every), jitter_(config.jitter),
      start_(instant_of(config.start)), stop_(instant_of(config.stop)), count_(config.count),
      rng_(rng) {
  assert(pattern_ == arrivals::saturated || every_ > 0s);
  assert(jitter_ >= 0s);
}

void schedule::start(instant now) {
  switch (pattern_) {
  case arrivals::periodic:
    base_ = first_of_grid(now);
    plan(later(base_, jitter()));
    return;
  case arrivals::poisson:
    plan(first_of_poisson(now));
    return;
  case arrivals::saturated:
    plan(later(std::max(now, start_.value_or(now)), rng_.between(0s, phase_max)));
    return;
  }
}

instant schedule::first_of_grid(instant now) {
  if (!start_)
    return later(now, rng_.between(0s, every_));
  if (*start_ >= now)
    return *start_;
  const auto behind = (now - *start_) % every_;
  return behind == 0s ? now : later(now, every_ - behind);
}

instant schedule::first_of_poisson(instant now) {
  if (!start_)
    return later(now, rng_.between(0s, every_));
  return *start_ >= now ? *start_ : later(now, gap());
}

void schedule::on_time(instant now) {
  if (stop_ && now >= *stop_)
    end(*stop_);
}

void schedule::on_request(instant now) {
  assert(due_ && *due_ <= now);
  ++requests_;
  if (!first_)
    first_ = now;
  switch (pattern_) {
  case arrivals::periodic:
    base_ = later(base_, every_);
    plan(later(base_, jitter()));
    return;
  case arrivals::poisson:
    plan(later(*due_, gap()));
    return;
  case arrivals::saturated:
    due_.reset();
    return;
  }
}

void schedule::on_answer(instant requested, instant now) {
  if (pattern_ == arrivals::saturated && !ended_)
    plan(now > requested ? now : later(now, retry_min));
}

void schedule::end(instant now) {
  due_.reset();
  ended_ = std::min(now, ended_.value_or(now));
}

std::optional<schedule::span> schedule::active(instant now) const {
  if (!first_)
    return {};
  const auto until = std::min({now, ended_.value_or(now), stop_.value_or(now)});
  return span{*first_, std::max(*first_, until)};
}

duration schedule::jitter() {
  return rng_.between(0s, jitter_);
}

/// Exponential, of mean `every`.
duration schedule::gap() {
  const auto ns = -math::log(1 - rng_.unit()) * static_cast<double>(every_.count());
  return duration(static_cast<duration::rep>(std::min(ns, gap_max_ns)));
}

void schedule::plan(instant at) {
  if (stop_ && at >= *stop_)
    end(*stop_);
  else if (count_ && requests_ >= *count_)
    end(at);
  else
    due_ = at;
}

} // namespace rubicon::traffic
