#include "actors/island/mote_groups.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/core.h>

#include "actors/island/network_radio.hpp"
#include "actors/island/smepp_shell.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/supervision.hpp"
#include "network/am.hpp"

namespace rubicon {

namespace {

/// What SMEPP Light of the mote requests.
struct group_performer {
  mote_shell mote;

  void operator()(smepp::send_frame& x) const {
    const acting_on its(x.from);
    const auto& arguments = *mote.state().arguments;
    mote.state().groups->psdu_size = x.octets.size() + radio::overhead;
    mote.self->send(arguments.air, request_of(arguments.radio, std::move(x)));
  }
  void operator()(smepp::store_state& x) const {
    *mote.state().arguments->smepp_state = std::move(x.content);
  }
  void operator()(const smepp::set_radio& x) const {
    auto demand = mote.state().radio;
    demand.groups = x.on;
    mote.set_radio(demand);
  }
  void operator()(const smepp::forward_event& x) const {
    auto& node = *mote.state().node;
    node.begin(mote.own_time());
    mote.state().groups->relay->forward(x.channel, x.value);
    mote.perform(node.settle(mote.own_time()));
  }
  void operator()(const smepp::computes& x) const {
    const auto& arguments = *mote.state().arguments;
    mote.self->send(arguments.air, computation{arguments.radio, x.length});
  }
  void operator()(smepp::notable& x) const { mote.notify_ecology(std::move(x.what)); }
};

} // namespace

void mote_groups::perform(smepp::node_outputs todo) const {
  for (auto& x : todo)
    std::visit(group_performer{{self_}}, x);
  auto& state = self_->state;
  if (const auto due = state.groups->node.deadline())
    state.groups_wake.follow(self_, std::max(now(self_), state.groups->crystal.real(*due)));
  else
    state.groups_wake.stop();
}

bool mote_groups::accept_frame(const radio::frame& x, byte_view psdu) const {
  if (x.am_type != network::am::smepp)
    return false;
  auto& groups = self_->state.groups;
  if (groups && !self_->state.flat)
    perform(groups->node.on_frame(x.source, x.destination, x.payload,
                                  groups->own(sfd_of(psdu, now(self_))), groups->own(now(self_))));
  return true;
}

void mote_groups::on_sent(std::uint64_t id, const radio_done& x) const {
  if (self_->state.flat)
    return;
  auto& groups = *self_->state.groups;
  const auto sfd = sfd_of(groups.psdu_size, now(self_)); // a broadcast is not acknowledged
  perform(groups.node.on_sent(id, x.status == radio::send_status::sent, groups.own(sfd),
                              groups.own(now(self_))));
}

void mote_groups::on_time() const {
  auto& groups = *self_->state.groups;
  perform(groups.node.on_time(groups.own(now(self_))));
}

void mote_groups::set_keys(const set_network_keys& x) const {
  if (auto& groups = self_->state.groups; groups && !self_->state.flat)
    perform(groups->node.set_network_keys(*x.keys, groups->own(now(self_))));
}

void mote_groups::start(const std::string& life) const {
  auto& state = self_->state;
  const auto& arguments = *state.arguments;
  if (!arguments.smepp)
    return;
  const auto& crystal = state.crystal;
  state.groups = std::make_unique<smepp_shell>(smepp_shell{
      smepp::node(*arguments.smepp, random_stream(arguments.seed, life + "/smepp"),
                  crystal.own(instant{}), crystal.own(now(self_)), *arguments.smepp_state),
      crystal});
  auto& groups = *state.groups;
  const auto octets = groups.node.own().footprint() + (state.node ? state.node->footprint() : 0);
  if (const auto most = arguments.smepp->settings.memory_max;
      octets > most && state.store.starts == 0)
    mote_shell{self_}.notify_ecology(
        fmt::format("needs {} octets of memory with all tables full, more than {}", octets, most));
  if (state.node) {
    groups.node.set_reader(
        [self = self_](device::quantity x) { return self->state.node->read(x, now(self)); });
    auto relay = std::make_unique<event_relay>();
    groups.relay = relay.get();
    state.reports.start_as(*state.node, "mote_app/" + arguments.name + "/event_relay",
                           std::move(relay), now(self_));
  }
  perform(groups.node.start(groups.own(now(self_))));
}

} // namespace rubicon
