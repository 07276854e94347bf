// Radios that listen at low power: when they are switched on and off while their motes are on.
#include "radio/channel/channel.hpp"

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
  if (!x.listens)
    return;
  const auto& config = x.listens->config;
  const mote_address who{island_id{x.pan}, x.address};
  x.listens->ears.emplace(config, first_check(config, noise_seed_, who, now), now);
  schedule_listening(radio);
}

void channel::end_listening(radio_index radio) {
  const auto& x = at(radio);
  if (!x.listens)
    return;
  x.listens->ears.reset();
  ++x.listens->event_stamp;
}

void channel::stay_awake(radio_index radio, instant now) {
  const auto& x = at(radio);
  if (!x.listens || !x.listens->ears)
    return;
  auto& ears = *x.listens->ears;
  const auto due = ears.deadline();
  if (ears.stay_awake(now))
    medium_.switch_on(radio, now);
  if (ears.deadline() != due)
    schedule_listening(radio);
}

void channel::on_listening(radio_index radio, instant now) {
  const auto& x = at(radio);
  auto& ears = *x.listens->ears;
  const bool was_on = ears.is_on();
  const bool busy = x.sender.open() > 0 || x.ack_dsn || medium_.sending(radio).has_value() ||
                    medium_.receives(radio);
  const bool was_busy = ears.now_in() == listener::state::checking &&
                        medium_.was_busy(radio, ears.checked_from(), now);
  ears.on_time(now, was_busy, busy);
  if (ears.is_on() && !was_on) {
    medium_.switch_on(radio, now);
    medium_.meter(radio).compute(x.listens->config.check, now); // the MCU takes the samples
  } else if (!ears.is_on() && was_on) {
    medium_.switch_off(radio, now);
  }
  schedule_listening(radio);
}

/// Switching a radio has no output of its own: what it receives is output when its frame ends.
void channel::schedule_listening(radio_index radio) {
  auto& x = *at(radio).listens;
  const auto due = x.ears->deadline();
  queue_.push_silent({.at = due,
                      .output_at = due,
                      .stamp = ++x.event_stamp,
                      .subject = radio.value,
                      .kind = event_kind::listening});
}

} // namespace rubicon::radio
