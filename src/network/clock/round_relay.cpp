#include "network/clock/round_relay.hpp"

namespace rubicon::network {

void round_relay::on_round(instant now, random_stream& rng) {
  hasten(now, rng);
  copies_ = 1;
  relays_ = 0;
}

void round_relay::on_copy(bool is_urgent) {
  if (++copies_ >= config_.copies_max && !is_urgent)
    due_.reset();
}

void round_relay::hasten(instant now, random_stream& rng) {
  if (!due_)
    due_ = now + rng.between(0s, config_.spread);
}

void round_relay::on_relayed(instant now, random_stream& rng) {
  if (++relays_ < config_.relays_max && copies_ < config_.copies_max)
    due_ = now + rng.between(config_.pause / 2, config_.pause);
}

} // namespace rubicon::network
