#include "network/clock/time_answers.hpp"

namespace rubicon::network {

bool time_answers::on_request(bool asks, instant now, random_stream& rng) {
  if (asks)
    left_ = config_.each;
  if (due_ || now - answered_ < config_.gap)
    return false;
  answered_ = now;
  others_ = 0;
  due_ = now + rng.between(0s, config_.spread);
  return true;
}

void time_answers::on_answer() {
  if (!due_ || ++others_ < config_.others_max)
    return;
  due_.reset();
  left_ = 0;
}

void time_answers::on_beacon(instant now) {
  due_.reset();
  if (left_ > 0 && --left_ > 0)
    due_ = now + config_.gap;
}

} // namespace rubicon::network
