#include "actors/peis/peis_lan.hpp"

#include <algorithm>
#include <utility>

#include "actors/base/timer.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/supervision.hpp"

namespace rubicon {

namespace {

using lan_pointer = scheduler::actor_pointer<peis_lan_state, peis_lan_actor>;

struct peis_lan_performer {
  lan_pointer self;

  void operator()(const peis::link_made& x) const {
    later(x.station, link_opened{x.link.value, user(x.other), x.role == peis::link_role::initiator,
                                 x.attempt.value, x.condition});
  }
  void operator()(const peis::link_refused& x) const {
    later(x.station, attempt_failed{x.attempt.value});
  }
  void operator()(const peis::link_reset& x) const { later(x.station, link_closed{x.link.value}); }
  void operator()(peis::announcement_heard& x) const {
    later(x.station, announcement{std::move(x.octets)});
  }
  void operator()(const peis::condition_set& x) const {
    self->send(user(x.station), condition_changed{x.link.value, x.condition});
  }

  [[nodiscard]] const lan_user_actor& user(peis::station_id x) const {
    return self->state.users.at(x);
  }

  template <class Message>
  void later(peis::station_id to, Message x) const {
    self->delayed_send(user(to), self->state.delay, std::move(x));
  }
};

void perform(lan_pointer self, peis::simulated_lan::outputs todo) {
  for (auto& output : todo)
    std::visit(peis_lan_performer{self}, output);
}

void on_join(lan_pointer self, const join_lan& x) {
  self->monitor(x.user);
  self->state.users[peis::station_id{x.station}] = x.user;
  self->state.lan.join(peis::station_id{x.station}, x.id, x.hears);
}

void on_down(lan_pointer self, const caf::down_msg& x) {
  auto& state = self->state;
  const auto gone = std::ranges::find_if(
      state.users, [&](const auto& each) { return each.second.address() == x.source; });
  if (gone == state.users.end())
    return;
  const auto station = gone->first;
  state.users.erase(gone);
  perform(self, state.lan.end(station));
}

} // namespace

peis_lan_actor::behavior_type peis_lan(lan_pointer self, const config::peis_description& network,
                                       std::uint64_t seed) {
  self->set_down_handler([self](const caf::down_msg& x) { on_down(self, x); });
  auto& state = self->state;
  state.lan = peis::simulated_lan(network.loss, random_stream(seed, self->path()));
  state.delay = network.delay;
  return {
      [self](const join_lan& x) { on_join(self, x); },
      [self](const lan_connect& x) {
        perform(self, self->state.lan.connect(peis::station_id{x.station},
                                              peis::attempt_id{x.attempt}, x.to));
      },
      [self](const lan_announce& x) {
        perform(self, self->state.lan.announce(peis::station_id{x.station}, x.octets, now(self)));
      },
      [self](const lan_link_ended& x) { self->state.lan.end_link(peis::link_id{x.link}); },
      [self](const set_lan_power& x) {
        perform(self, self->state.lan.set_power(peis::station_id{x.station}, x.on));
      },
      [self](const begin_lan_fault& x) {
        perform(self, self->state.lan.begin_fault(x.fault, {x.groups, x.loss, x.lossy}));
      },
      [self](const end_lan_fault& x) { perform(self, self->state.lan.end_fault(x.fault)); },
  };
}

} // namespace rubicon
