// Radios that listen at low power: when they are switched on and off while their motes are on.
#include "radio/channel.hpp"

namespace rubicon::radio {

namespace {

/// Where in the interval a radio's checks begin: its own matter, whichever others there are.
instant first_check(const listening_config& config, std::uint64_t seed, const mote_address& who,
                    instant now) {
  random_stream rng(seed, "listening/" + to_string(who));
  return now + rng.between(0s, config.interval);
}

} // namespace

/// The mote of a radio is on from now on.
void channel::begin_listening(radio_index radio, instant now) {
  auto& x = at(radio);
  if (!x.listening.enabled() || !x.listening.checks)
    return;
  const mote_address who{island_id{x.pan}, x.address};
  x.ears.emplace(x.listening, first_check(x.listening, noise_seed_, who, now), now);
  schedule_listening(radio);
}

void channel::end_listening(radio_index radio) {
  auto& x = at(radio);
  x.ears.reset();
  ++x.ears_stamp;
}

void channel::stay_awake(radio_index radio, instant now) {
  auto& x = at(radio);
  if (!x.ears)
    return;
  const auto due = x.ears->deadline();
  if (x.ears->stay_awake(now))
    medium_.switch_on(radio, now);
  if (x.ears->deadline() != due)
    schedule_listening(radio);
}

void channel::on_listening(radio_index radio, instant now) {
  auto& x = at(radio);
  const bool was_on = x.ears->is_on();
  const bool busy = x.sender.open() > 0 || x.ack_dsn || medium_.sending(radio).has_value() ||
                    medium_.receives(radio);
  const bool heard = x.ears->now_in() == listener::state::checking &&
                     medium_.was_busy(radio, x.ears->checked_from(), now);
  x.ears->on_time(now, heard, busy);
  if (x.ears->is_on() && !was_on) {
    medium_.switch_on(radio, now);
    medium_.meter(radio).compute(x.listening.check, now); // the MCU takes the samples
  } else if (!x.ears->is_on() && was_on) {
    medium_.switch_off(radio, now);
  }
  schedule_listening(radio);
}

/// Whatever a radio that is switched on may receive is told when its frame ends: that of itself is
/// nothing to be told.
void channel::schedule_listening(radio_index radio) {
  auto& x = at(radio);
  queue_.push_untold({.at = x.ears->deadline(),
                      .told_at = x.ears->deadline(),
                      .stamp = ++x.ears_stamp,
                      .subject = radio.value,
                      .kind = event_kind::listening});
}

} // namespace rubicon::radio
