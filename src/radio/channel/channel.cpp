#include "radio/channel/channel.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "radio/medium/power.hpp"
#include "radio/medium/reception.hpp"

namespace rubicon::radio {

namespace {

/// Below every signal.
constexpr double no_limit_dbm = -160;

const mac_rules* rules_for(const platform& kind, const channel_config& config) {
  const auto* rules = mac_of(config, kind);
  assert(rules != nullptr);
  return rules;
}

mote_address name_of(const radio_config& x) {
  return {island_id{x.pan}, x.address};
}

} // namespace

channel::channel(const channel_config& config, random_stream rng)
    : config_(config), rng_(rng), topology_(config, rng_.next()), medium_(config),
      noise_seed_(rng_.next()) {}

void channel::reserve(std::size_t radios) {
  stations_.reserve(radios);
  medium_.reserve(radios);
}

radio_index channel::add(const radio_config& config, instant now) {
  assert(config.kind != nullptr);
  assert(queue_.empty() || queue_.top().at >= now);
  const auto& kind = *config.kind;
  const auto transmit_dbm = config.transmit_dbm.value_or(kind.transmit_dbm_max());
  const auto sensitivity_dbm = config_.sensitivity_dbm.value_or(kind.sensitivity_dbm);
  const bool by_noise = config_.edge == sensitivity_edge::noise &&
                        !std::holds_alternative<unit_disk>(config_.propagation);
  const auto own_noise =
      by_noise ? to_units(sensitivity_dbm - to_db(sinr_at_sensitivity(config_.curve))) : 0;
  const auto radio =
      topology_.add({name_of(config), config.place, transmit_dbm, own_noise, config.channel});
  transceiver_config ears;
  ears.address = config.address;
  ears.pan = config.pan;
  ears.promiscuous = config.promiscuous;
  ears.sensitivity_dbm = by_noise ? no_limit_dbm : sensitivity_dbm;
  ears.own_noise = own_noise;
  ears.cca_dbm = config_.cca_dbm.value_or(kind.cca_dbm);
  ears.noise = topology_.noise(radio);
  if (const auto* traced = std::get_if<traced_noise>(&config_.noise))
    ears.traced_noise = std::make_unique<noise_source>(
        traced->trace, random_stream(noise_seed_, to_string(name_of(config))));
  medium_.add(std::move(ears),
              energy_meter(&kind, config.battery_mah.value_or(kind.battery_mah), transmit_dbm, now),
              now);
  const auto* rules = rules_of(config);
  station x;
  x.address = config.address;
  x.pan = config.pan;
  x.battery.begin(now);
  x.next_dsn = static_cast<std::uint8_t>(rules->dsn_from_address ? 16 * config.address.value
                                                                 : rng_.below(256));
  if (config.listening.enabled() && config.listening.checks)
    x.listens = std::make_unique<low_power_listening>(low_power_listening{config.listening, {}, 0});
  x.sender = mac(rules, config_.queue, retries_of(config, *rules), config.listening.train());
  x.inbox = receiver(rules, config_.receive_slots.value_or(kind.receive_slots),
                     memory_of(config, *rules));
  x.service_time = config_.service_time.value_or(kind.service_time);
  guards_ = guards_ || rules->guard > 0s;
  sleeps_ = sleeps_ || x.listens != nullptr;
  stations_.push_back(std::move(x));
  begin_listening(radio, now);
  watch_battery(radio, now);
  return radio;
}

void channel::compute(radio_index radio, duration length, instant now) {
  medium_.meter(radio).compute(length, now);
}

unsigned channel::retries_of(const radio_config& config, const mac_rules& rules) const {
  return config.access.retries_max.value_or(config_.retries_max.value_or(rules.retries_max));
}

const mac_rules* channel::rules_of(const radio_config& config) {
  const auto* rules = rules_for(*config.kind, config_);
  if (!config.access.is_set())
    return rules;
  own_rules_.push_back(std::make_unique<const mac_rules>(adjusted(*rules, config.access)));
  return own_rules_.back().get();
}

/// How long the radio remembers a frame: as long as radios like it may repeat one, and as those
/// with parameters of their own may.
duration channel::memory_of(const radio_config& config, const mac_rules& rules) {
  const bool has_own = config.access.is_set() || config.listening.enabled();
  const auto repeats = config.listening.enabled()
                           ? config.listening.train() + rules.longest_gap() + air_time(psdu_max)
                           : rules.repeats_for(retries_of(config, rules));
  if (has_own && repeats > longest_own_) {
    longest_own_ = repeats;
    for (auto& each : stations_)
      each.inbox.remember_for(longest_own_);
  }
  return std::max(repeats, longest_own_);
}

void channel::move(radio_index radio, position place) {
  topology_.move(radio, place);
}

void channel::set_loss(radio_index from, radio_index to, double loss) {
  topology_.set_loss(from, to, loss);
}

void channel::change(const link_override& x) {
  topology_.change(x);
}

outputs channel::set_noise(radio_index from, bool on, instant now) {
  outputs out;
  run_until(now, out);
  if (!on) {
    medium_.end_noise(from, now);
    return out;
  }
  queue_.doubt(); // an assessment may find the channel busy now
  medium_.start_noise(from, topology_.around(from), now);
  return out;
}

void channel::restart_energy(radio_index radio, double used_mah, instant now) {
  medium_.meter(radio).restart(used_mah, now);
  at(radio).battery.begin(now);
  watch_battery(radio, now);
}

outputs channel::send(radio_index radio, request what, instant now) {
  outputs out;
  run_until(now, out);
  auto& x = at(radio);
  ++x.counted.requests.requests;
  if (x.supply != power::on) {
    conclude(radio, {.token = what.token, .status = send_status::aborted}, out);
    return out;
  }
  if (x.sender.full()) {
    conclude(radio, {.token = what.token, .status = send_status::queue_full}, out);
    return out;
  }
  auto frame = pack(x, what);
  frame.asked = now;
  stay_awake(radio, now);
  x.sender.submit(std::move(frame), now, rng_);
  follow(radio, {}, now, out);
  return out;
}

outputs channel::set_power(radio_index radio, power state, instant now) {
  outputs out;
  run_until(now, out);
  auto& x = at(radio);
  if (x.supply == state || x.supply == power::flat)
    return out;
  if (x.supply == power::on)
    silence(radio, now, out);
  x.supply = state;
  switch (state) {
  case power::on:
    medium_.switch_on(radio, now);
    begin_listening(radio, now);
    break;
  case power::off:
    break;
  case power::flat:
    run_down(radio, now);
    break;
  }
  return out;
}

outputs channel::on_time(instant now) {
  outputs out;
  run_until(now, out);
  return out;
}

std::optional<instant> channel::deadline() {
  return queue_.next_output(ran_until_, [this](const event& x) { return is_current(x); });
}

// ------------------------------------------------------------------------------------------ events

void channel::run_until(instant now, outputs& out) {
  ran_until_ = std::max(ran_until_, now);
  while (!queue_.empty()) {
    const auto next = queue_.top();
    if (is_current(next)) {
      if (next.at > now)
        return;
      queue_.pop();
      ++events_;
      handle(next, out);
    } else {
      queue_.pop();
    }
  }
}

bool channel::is_current(const event& x) const {
  const radio_index radio{x.subject};
  switch (x.kind) {
  case event_kind::mac_timer:
    return at(radio).mac_stamp == x.stamp;
  case event_kind::ack_due:
    return at(radio).ack_stamp == x.stamp;
  case event_kind::frame_end:
    return medium_.stamp(x.subject) == x.stamp;
  case event_kind::battery_low:
    return at(radio).supply != power::flat;
  case event_kind::listening:
    return at(radio).listens->event_stamp == x.stamp;
  }
  return false;
}

void channel::handle(const event& x, outputs& out) {
  const radio_index radio{x.subject};
  switch (x.kind) {
  case event_kind::mac_timer:
    return on_mac_timer(radio, x.at, out);
  case event_kind::ack_due:
    return on_ack_due(radio, x.at);
  case event_kind::frame_end:
    return on_frame_end(x.subject, x.at, out);
  case event_kind::battery_low:
    return on_battery_low(radio, x.at, out);
  case event_kind::listening:
    return on_listening(radio, x.at);
  }
}

void channel::on_mac_timer(radio_index radio, instant now, outputs& out) {
  auto& x = at(radio);
  x.scheduled.reset();
  const bool clear = !x.sender.assesses() || (x.guarded_until <= now && medium_.clear(radio, now));
  const auto todo = x.sender.on_time(now, clear, rng_);
  follow(radio, todo, now, out);
}

void channel::on_ack_due(radio_index radio, instant now) {
  auto& x = at(radio);
  transmission ack;
  ack.from = radio;
  ack.content.type = frame_type::ack;
  ack.content.dsn = *x.ack_dsn;
  x.ack_dsn.reset();
  if (medium_.sending(radio)) // by energy alone it did not sense the frame: its own came first
    return;
  ++x.counted.acks;
  ack.length = air_time(ack_size);
  put_on_air(std::move(ack), now);
}

void channel::on_frame_end(slot_index slot, instant now, outputs& out) {
  const auto sender = medium_.content(slot).from;
  const bool is_data = medium_.content(slot).content.type == frame_type::data;
  end_frame(slot, now, out);
  if (is_data)
    follow(sender, at(sender).sender.on_sent(now, rng_), now, out);
}

void channel::on_battery_low(radio_index radio, instant now, outputs& out) {
  auto& x = at(radio);
  const auto found = x.battery.look(medium_.meter(radio), now);
  if (found.runs_low)
    out.emplace_back(running_low{radio});
  if (!found.is_flat) {
    watch_battery(radio, now);
    return;
  }
  if (x.supply == power::on)
    silence(radio, now, out);
  x.supply = power::flat;
  run_down(radio, now);
  out.emplace_back(exhausted{radio});
}

void channel::run_down(radio_index radio, instant now) {
  medium_.meter(radio).stop(now);
  at(radio).battery.run_down(now);
}

void channel::watch_battery(radio_index radio, instant now) {
  if (const auto due = at(radio).battery.next_look(medium_.meter(radio), now))
    queue_.push({.at = *due,
                 .output_at = *due,
                 .stamp = 0,
                 .subject = radio.value,
                 .kind = event_kind::battery_low});
}

energy_use channel::energy(radio_index radio, instant now) const {
  return at(radio).battery.use(medium_.meter(radio), medium_.times(radio, now), now);
}

instant channel::batteries_last_until() const {
  auto first = instant::max();
  for (const auto& x : stations_)
    first = std::min(first, x.battery.lasts_until());
  return first;
}

// ----------------------------------------------------------------------------------- medium access

void channel::follow(radio_index radio, const mac_action& todo, instant now, outputs& out) {
  if (todo.transmit)
    send_current(radio, now);
  if (todo.ended) {
    stay_awake(radio, now);
    conclude(radio, *todo.ended, out);
  }
  auto& x = at(radio);
  medium_.await_ack(radio, x.sender.now_in() == mac::state::ack_wait);
  const auto due = x.sender.deadline();
  if (due == x.scheduled)
    return;
  x.scheduled = due;
  ++x.mac_stamp;
  if (due)
    schedule_mac(radio, *due);
}

/// Mostly the next assessment of all will find the channel clear, whatever else comes after it. To
/// know that saves waking up for the case that it does not.
void channel::schedule_mac(radio_index radio, instant due) {
  auto& x = at(radio);
  const event cautious{.at = due,
                       .output_at = x.sender.earliest_output(),
                       .stamp = x.mac_stamp,
                       .subject = radio.value,
                       .kind = event_kind::mac_timer};
  const bool is_next = queue_.empty() || due < queue_.top().at;
  const bool is_sure =
      is_next && x.sender.assesses() && x.guarded_until <= due && medium_.stays_clear(radio, due);
  if (!is_sure)
    return queue_.push(cautious);
  auto hopeful = cautious;
  hopeful.output_at = x.sender.earliest_output_if_clear();
  queue_.push_sure(hopeful, cautious);
}

/// A radio that was on goes off.
void channel::silence(radio_index radio, instant now, outputs& out) {
  auto& x = at(radio);
  end_listening(radio);
  for (const auto& y : x.sender.abort())
    conclude(radio, y, out);
  x.scheduled.reset();
  ++x.mac_stamp;
  medium_.await_ack(radio, false);
  x.ack_dsn.reset();
  ++x.ack_stamp;
  x.inbox.reset();
  if (const auto slot = medium_.sending(radio)) {
    medium_.cut(*slot);
    end_frame(*slot, now, out);
  }
  medium_.switch_off(radio, now);
  medium_.meter(radio).drop_work(now);
}

} // namespace rubicon::radio
