#include "network/clock/period_requests.hpp"

#include <algorithm>

namespace rubicon::network {

void period_requests::on_round(instant now) {
  if (round_)
    period_ = now - *round_;
  round_ = now;
}

std::optional<duration> period_requests::on_time(std::optional<duration> wanted, instant now,
                                                 random_stream& rng) {
  if (!wanted || period_ <= *wanted * 5 / 4) {
    due_.reset();
    return std::nullopt;
  }
  if (!due_)
    due_ = std::max(now, requested_ + gap) + rng.between(0s, spread);
  if (*due_ > now)
    return std::nullopt;
  due_.reset();
  requested_ = now;
  return wanted;
}

} // namespace rubicon::network
