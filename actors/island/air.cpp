#include "actors/island/air.hpp"

#include <map>

#include "actors/base/log.hpp"
#include "actors/base/statuses.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/supervision.hpp"

namespace rubicon {

namespace {

using air_pointer = scheduler::actor_pointer<air_state, air_actor>;

std::size_t slot(radio::radio_index x) {
  return x.value;
}

struct air_performer {
  air_pointer self;

  void operator()(radio::delivered& x) const {
    const acting_on its(x.from);
    if (const auto& user = self->state.users[slot(x.to)])
      self->send(user, frame_received{std::move(x.psdu), x.rssi_dbm});
  }

  void operator()(const radio::done& x) const {
    const acting_on its(x.from);
    if (x.status != radio::send_status::sent)
      log(self, spdlog::level::debug, "event=unsent radio={} cause={}",
          to_string(self->state.addresses[slot(x.radio)]), radio::to_string(x.status));
    if (const auto& user = self->state.users[slot(x.radio)])
      self->send(user, radio_done{x.token, x.status, x.transmissions, x.arrived, x.last});
  }

  void operator()(const radio::overheard& x) const { self->state.observe(x); }

  void operator()(const radio::running_low& x) const {
    if (const auto& user = self->state.users[slot(x.radio)])
      self->send(user, battery_low{});
  }

  void operator()(const radio::exhausted& x) const {
    if (const auto& user = self->state.users[slot(x.radio)])
      self->send(user, battery_flat{});
  }
};

void perform(air_pointer self, radio::outputs todo) {
  for (auto& output : todo)
    std::visit(air_performer{self}, output);
  self->state.wake.follow(self, self->state.channel.deadline());
}

energy_status energy_of(air_pointer self, radio::radio_index radio) {
  const auto use = self->state.channel.energy(radio, now(self));
  return {self->state.addresses[slot(radio)],
          {use.elapsed, use.used_mah, use.battery_mah, use.times.mcu_active, use.times.mcu_sleep,
           use.times.radio_off, use.times.radio_listen, use.times.radio_receive,
           use.times.radio_transmit}};
}

void send_status(air_pointer self) {
  auto& state = self->state;
  perform(self, state.channel.on_time(now(self)));
  std::map<island_id, radio::radio_counters> islands;
  for (std::size_t i = 0; i < state.addresses.size(); ++i) {
    if (state.tells_energy[i])
      self->send(state.ecology, energy_of(self, radio::radio_index(static_cast<std::uint32_t>(i))));
  }
  const auto counted = state.channel.counts().by_radio();
  for (std::size_t i = 0; i < state.addresses.size(); ++i) // sources of noise count nothing
    islands[state.addresses[i].island] += counted[i];
  for (const auto& [island, counters] : islands)
    self->send(state.ecology, radio_status{island, report_of(counters)});
}

void follow_faults(air_pointer self) {
  std::optional<instant> due;
  for (const auto& x : self->state.noises)
    due = earliest(due, x.what.deadline());
  for (const auto& x : self->state.losses)
    due = earliest(due, x.until);
  self->state.fault_wake.follow(self, due);
}

void on_fault_time(air_pointer self) {
  auto& state = self->state;
  for (auto& x : state.noises) {
    const bool sent = x.what.sends();
    if (x.what.on_time(now(self)) != sent)
      perform(self, state.channel.set_noise(x.from, !sent, now(self)));
  }
  std::erase_if(state.noises, [](const auto& x) { return !x.what.deadline(); });
  perform(self, state.channel.on_time(now(self)));
  for (const auto& x : state.losses)
    if (x.until <= now(self))
      state.channel.end_loss(x.name);
  std::erase_if(state.losses, [self](const auto& x) { return x.until <= now(self); });
  follow_faults(self);
}

/// A source that is still at work begins anew.
void on_noise(air_pointer self, const make_noise& x) {
  auto& state = self->state;
  std::erase_if(state.noises, [&](const auto& each) {
    if (each.from != x.from)
      return false;
    if (each.what.sends())
      perform(self, state.channel.set_noise(x.from, false, now(self)));
    return true;
  });
  const auto path = self->path() + "/noise/" + std::to_string(++state.noises_so_far);
  state.noises.push_back(
      {x.from, radio::interferer({x.duty, x.burst}, random_stream(state.seed, path), now(self),
                                 now(self) + x.length)});
  on_fault_time(self);
}

void on_loss(air_pointer self, const lose_frames& x) {
  auto& state = self->state;
  perform(self, state.channel.on_time(now(self)));
  const auto pan =
      x.everywhere ? std::nullopt : std::optional(static_cast<std::uint16_t>(x.island.value));
  state.losses.push_back({state.channel.begin_loss(pan, x.loss), now(self) + x.length});
  follow_faults(self);
}

void on_carry_away(air_pointer self, const carry_away& x) {
  auto& state = self->state;
  perform(self, state.channel.set_power(x.radio, radio::power::off, now(self)));
  state.users[slot(x.radio)] = nullptr;
  state.tells_energy[slot(x.radio)] = false;
  self->send(state.ecology, radio_left{energy_of(self, x.radio)});
}

void on_bring(air_pointer self, const bring_radio& x) {
  auto& state = self->state;
  perform(self, state.channel.on_time(now(self)));
  state.channel.restart_energy(x.radio, x.used_mah, now(self));
  state.tells_energy[slot(x.radio)] = true;
}

} // namespace

air_actor::behavior_type air(air_pointer self, radio::channel channel,
                             std::vector<mote_address> addresses, extra_radios extra,
                             std::uint64_t seed, ecology_actor ecology, frame_observer observe) {
  self->state.channel = std::move(channel);
  self->state.seed = seed;
  self->state.tells_energy.assign(addresses.size(), true);
  for (std::size_t i = addresses.size() - extra.motes; i < addresses.size(); ++i)
    self->state.tells_energy[i] = false;
  for (std::size_t i = 0; i < extra.motes + extra.noises; ++i) {
    const radio::radio_index radio{static_cast<std::uint32_t>(addresses.size() - extra.motes + i)};
    perform(self, self->state.channel.set_power(radio, radio::power::off, now(self)));
  }
  self->state.observe = std::move(observe);
  if (self->state.observe)
    self->state.channel.watch();
  self->state.users.resize(addresses.size());
  self->state.addresses = std::move(addresses);
  self->state.ecology = std::move(ecology);
  return {
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          perform(self, self->state.channel.on_time(now(self)));
        if (self->state.fault_wake.accepts(x))
          on_fault_time(self);
      },
      [self](const radio_send& x) {
        radio::request what{x.token, x.destination, x.am_type, x.octets, x.ack};
        if (x.age_at != no_age)
          what.age_at = x.age_at;
        what.in_slot = x.in_slot;
        perform(self, self->state.channel.send(x.radio, std::move(what), now(self)));
      },
      [self](const attach_radio& x) {
        self->state.users[slot(x.radio)] = x.user;
        perform(self, self->state.channel.set_power(x.radio, radio::power::on, now(self)));
      },
      [self](const radio_power& x) {
        perform(self, self->state.channel.set_power(x.radio, x.state, now(self)));
      },
      [self](const computation& x) { self->state.channel.compute(x.radio, x.length, now(self)); },
      [self](const move_radio& x) {
        perform(self, self->state.channel.on_time(now(self)));
        self->state.channel.move(x.radio, x.place);
      },
      [self](const make_noise& x) { on_noise(self, x); },
      [self](const lose_frames& x) { on_loss(self, x); },
      [self](const change_link& x) {
        perform(self, self->state.channel.on_time(now(self)));
        self->state.channel.change({x.from, x.to, x.loss, x.gain_db});
      },
      [self](const carry_away& x) { on_carry_away(self, x); },
      [self](const bring_radio& x) { on_bring(self, x); },
      [self](status_request) { send_status(self); },
      [self](const radio_send_raw& x) {
        radio::request what{.token = x.token, .payload = x.octets, .is_raw = true};
        perform(self, self->state.channel.send(x.radio, std::move(what), now(self)));
      },
  };
}

} // namespace rubicon
