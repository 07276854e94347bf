#include "actors/peis/peis_bluetooth.hpp"

#include <algorithm>
#include <utility>

#include "actors/messages/links.hpp"
#include "radio/parameters.hpp"

namespace rubicon {

namespace {

using bluetooth_pointer = scheduler::actor_pointer<peis_bluetooth_state, peis_bluetooth_actor>;

hello_answer message_of(const peis::say_hello& x, payload octets) {
  return {x.adapter, x.to, std::move(octets)};
}

struct peis_bluetooth_performer {
  bluetooth_pointer self;

  void operator()(const peis::link_made& x) const {
    later(x.station,
          bluetooth_opened{{x.link.value, user(x.other), x.role == peis::link_role::initiator,
                            x.attempt.value, x.condition},
                           self->state.rate_bps});
  }
  void operator()(const peis::link_refused& x) const {
    later(x.station, attempt_failed{x.attempt.value});
  }
  void operator()(const peis::link_reset& x) const { later(x.station, link_closed{x.link.value}); }
  void operator()(peis::devices_seen& x) const {
    later(x.station, bluetooth_seen{std::move(x.adapter), std::move(x.devices)});
  }
  void operator()(const peis::hello_heard& x) const {
    later(x.station, hello_arrived{message_of(x.question, x.question.octets), user(x.from)});
  }
  void operator()(const peis::hello_unheard& x) const {
    later(x.station, message_of(x.question, {}));
  }

  [[nodiscard]] const bluetooth_user_actor& user(peis::station_id x) const {
    return self->state.users.at(x);
  }

  template <class Message>
  void later(peis::station_id to, Message x) const {
    self->delayed_send(user(to), self->state.delay, std::move(x));
  }
};

void perform(bluetooth_pointer self, peis::simulated_bluetooth::outputs todo) {
  for (auto& output : todo)
    std::visit(peis_bluetooth_performer{self}, output);
}

void on_join(bluetooth_pointer self, const join_bluetooth& x) {
  self->monitor(x.user);
  self->state.users[peis::station_id{x.station}] = x.user;
  self->state.medium.join(peis::station_id{x.station}, x.machine, x.adapters, x.place, x.port);
}

void on_down(bluetooth_pointer self, const caf::down_msg& x) {
  auto& state = self->state;
  const auto gone = std::ranges::find_if(
      state.users, [&](const auto& each) { return each.second.address() == x.source; });
  if (gone == state.users.end())
    return;
  const auto station = gone->first;
  state.users.erase(gone);
  perform(self, state.medium.end(station));
}

} // namespace

peis_bluetooth_actor::behavior_type
peis_bluetooth(bluetooth_pointer self, const config::peis_description& network,
               const std::vector<config::bluetooth_device>& others) {
  self->set_down_handler([self](const caf::down_msg& x) { on_down(self, x); });
  auto& state = self->state;
  const radio::log_distance law;
  const auto& given = network.bluetooth;
  state.medium =
      peis::simulated_bluetooth({given.range_m, law.reference_db, law.exponent, given.takeover});
  state.delay = network.delay;
  state.rate_bps = given.rate_bps;
  for (const auto& each : others)
    state.medium.add_device(each.address, each.place);
  return {
      [self](const join_bluetooth& x) { on_join(self, x); },
      [self](const scan_bluetooth& x) {
        perform(self, self->state.medium.scan(peis::station_id{x.station}, x.adapter));
      },
      [self](const send_hello& x) {
        perform(self, self->state.medium.hello(
                          peis::station_id{x.station},
                          {x.question.adapter, x.question.device, x.question.octets}));
      },
      [self](const bluetooth_connect& x) {
        perform(self, self->state.medium.connect(peis::station_id{x.station},
                                                 peis::attempt_id{x.attempt}, x.to, x.port));
      },
      [self](const lan_link_ended& x) { self->state.medium.end_link(peis::link_id{x.link}); },
      [self](const set_lan_power& x) {
        perform(self, self->state.medium.set_power(peis::station_id{x.station}, x.on));
      },
      [self](const move_machine& x) { perform(self, self->state.medium.move(x.machine, x.place)); },
  };
}

} // namespace rubicon
