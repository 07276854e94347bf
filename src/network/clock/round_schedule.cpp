#include "network/clock/round_schedule.hpp"

#include <algorithm>

namespace rubicon::network {

namespace {

constexpr duration dispute_gap = 10s; ///< a root that is disputed repeats itself so often

} // namespace

round_schedule::round_schedule(round_config config, instant now)
    : config_(config), next_(now + config.resume_wait), listening_until_(next_),
      gap_(config.period_first) {}

void round_schedule::on_answer(instant now) {
  if (!listening_until_)
    return;
  listening_until_ = std::min(*listening_until_, now + config_.resume_more);
  next_ = listening_until_;
}

void round_schedule::restart(instant now) {
  if (is_listening())
    return;
  rounds_ = 0;
  gap_ = config_.period_first;
  next_ = now;
}

void round_schedule::restart_for_dispute(instant now) {
  if (disputed_ && now - *disputed_ < dispute_gap)
    return;
  disputed_ = now;
  restart(now);
}

void round_schedule::request(duration period, instant now) {
  const bool holds = requested_ && now < requested_until_;
  if (holds && *requested_ < period)
    return;
  requested_ = period;
  requested_until_ = now + config_.request_hold;
  if (!listening_until_ && next_)
    next_ = std::min(*next_, now + std::max(period, config_.period_least));
}

void round_schedule::advance(instant now) {
  auto longest = config_.period;
  if (requested_ && now < requested_until_)
    longest = std::clamp(*requested_, config_.period_least, longest);
  if (++rounds_ > config_.first_rounds)
    gap_ = std::min(2 * gap_, longest);
  next_ = now + gap_;
}

} // namespace rubicon::network
