#include "radio/medium/interferer.hpp"

#include <algorithm>
#include <cassert>

namespace rubicon::radio {

interferer::interferer(interferer_config config, random_stream rng, instant now, instant until)
    : config_(config), rng_(rng), until_(until) {
  assert(config.duty > 0 && config.duty <= 1 && config.burst > 0s);
  next_ = std::min(now + gap(), until_);
}

duration interferer::gap() {
  const auto mean = static_cast<double>(config_.burst.count()) * (1 / config_.duty - 1);
  return duration(static_cast<duration::rep>(2 * mean * rng_.unit()));
}

bool interferer::on_time(instant now) {
  while (next_ && *next_ <= now) {
    if (*next_ >= until_) {
      sends_ = false;
      next_.reset();
    } else if (config_.duty == 1) {
      sends_ = true;
      next_ = until_;
    } else {
      sends_ = !sends_;
      next_ = std::min(*next_ + (sends_ ? config_.burst : gap()), until_);
    }
  }
  return sends_;
}

} // namespace rubicon::radio
