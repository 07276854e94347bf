#include "mote/crystal.hpp"

#include <cmath>

namespace rubicon::mote {

namespace {

constexpr std::int64_t billion = 1'000'000'000;
constexpr duration boot_time_max = 1h;

} // namespace

duration boot_time(random_stream rng) {
  return rng.between(0s, boot_time_max);
}

crystal::crystal(const crystal_config& config) : config_(config) {}

crystal crystal::ahead_by(duration x) const {
  auto other = *this;
  other.ahead_ += x;
  return other;
}

/// By how much the wander alone has put it ahead, since its phase was 0: the area below a rate that
/// rises from -1 to 1 in the first half of the period and falls back in the second.
duration crystal::wandered(duration since) const {
  const auto half = config_.wander_period / 2;
  const auto into = since % config_.wander_period;
  const bool rises = into < half;
  const auto t = static_cast<double>((rises ? into : into - half).count());
  const auto area = t * (t / static_cast<double>(half.count()) - 1);
  const auto ppb = static_cast<double>(rises ? config_.wander_ppb : -config_.wander_ppb);
  return duration(static_cast<duration::rep>(std::floor(area * (ppb * 1e-9))));
}

instant crystal::own(instant real) const {
  const auto since = real.time_since_epoch().count();
  auto ahead = duration(since / billion * config_.ppb + since % billion * config_.ppb / billion);
  if (config_.wander_ppb != 0)
    ahead += wandered(real.time_since_epoch() + config_.phase) - wandered(config_.phase);
  return real + ahead + ahead_;
}

instant crystal::real(instant own) const {
  auto guess = own - ahead_;
  auto shown = this->own(guess);
  for (int i = 0; i < 4 && shown != own; ++i) { // each brings it nearer by a factor of 1e9 / ppb
    guess += own - shown;
    shown = this->own(guess);
  }
  for (; shown < own; shown = this->own(guess))
    guess += 1ns;
  while (this->own(guess - 1ns) >= own)
    guess -= 1ns;
  return guess;
}

} // namespace rubicon::mote
