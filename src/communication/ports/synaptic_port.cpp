#include "communication/ports/synaptic_port.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace rubicon::communication {

int synaptic_port::create(std::size_t program, bool is_out, mote_address other, std::uint8_t size,
                          const synaptic::parameters& params) {
  if (!node_.may_send()) {
    node_.refuse();
    return -1;
  }
  const auto self = node_.address();
  const auto slack = messages_.far_slack(other);
  auto x = is_out ? synaptic_.create_out(self, other, size, params, node_.now, slack)
                  : synaptic_.create_in(self, other, size, params, node_.now, slack);
  if (x.refused) {
    node_.refuse();
    return -1;
  }
  owners_[x.channel] = program;
  apply(std::move(x.todo));
  return x.channel.value;
}

status synaptic_port::accept(synaptic::answer x) {
  if (x.refused)
    return node_.refuse();
  apply(std::move(x.todo));
  return SUCCESS;
}

status synaptic_port::dispose(synaptic::descriptor channel) {
  const auto done = accept(synaptic_.dispose(channel));
  if (done == SUCCESS)
    owners_.erase(channel);
  return done;
}

status synaptic_port::start(synaptic::descriptor channel) {
  return accept(synaptic_.start(channel));
}

status synaptic_port::stop(synaptic::descriptor channel) {
  return accept(synaptic_.stop(channel));
}

status synaptic_port::write_output(synaptic::descriptor channel, std::uint8_t k, float value) {
  return synaptic_.write_output(channel, k, value) ? node_.refuse() : SUCCESS;
}

float synaptic_port::read_input(synaptic::descriptor channel, std::uint8_t index) {
  return synaptic_.read_input(channel, index).value_or(std::numeric_limits<float>::quiet_NaN());
}

void synaptic_port::leave(std::size_t program) {
  for (const auto id : owned(owners_, program))
    dispose(id);
}

void synaptic_port::on_connected(std::uint16_t descriptor, stream::channel_handle channel) {
  apply(synaptic_.on_connected(synaptic::descriptor(descriptor), channel, node_.now));
}

void synaptic_port::on_connect_failed(std::uint16_t descriptor) {
  apply(synaptic_.on_connect_failed(synaptic::descriptor(descriptor)));
}

void synaptic_port::on_accepted(stream::channel_handle channel, mote_address source,
                                duration far_slack) {
  apply(synaptic_.on_accepted(channel, source, node_.now, far_slack));
}

void synaptic_port::on_octets(stream::channel_handle channel, byte_view octets) {
  apply(synaptic_.on_channel_octets(channel, octets));
}

void synaptic_port::on_closed(stream::channel_handle channel) {
  apply(synaptic_.on_channel_closed(channel));
}

void synaptic_port::on_tick(std::uint32_t tick, instant now) {
  node_.now = now;
  apply(synaptic_.on_tick(tick, now));
  for (std::size_t i = 0; i < programs_.size(); ++i) {
    if (programs_.wants_ticks(i))
      programs_.notify(i, [tick](auto& x) { x.clock_tick(tick); });
  }
  programs_.dispatch();
}

bool synaptic_port::wants_ticks() const {
  return synaptic_.open_channels() > 0 || programs_.any_wants_ticks();
}

void synaptic_port::set_slot(duration offset) {
  synaptic_.set_slot(std::max(offset, own_layer_config::slot_min));
}

std::vector<vector_end> synaptic_port::vector_ends() const {
  std::vector<vector_end> found;
  for (const auto& x : synaptic_.out_ends()) {
    const bool is_near = x.channel && !channel_port::is_tunnel(*x.channel);
    found.push_back({x.size, x.channel.has_value(), is_near ? x.channel : std::nullopt});
  }
  return found;
}

void synaptic_port::on_time() {
  apply(synaptic_.on_time(node_.now));
}

void synaptic_port::apply(synaptic::outputs todo) {
  for (auto& each : todo) {
    if (const auto* request = std::get_if<synaptic::connect_channel>(&each)) {
      channels_.connect({true, request->channel.value}, request->destination, request->interval,
                        request->size, request->qos);
    } else if (auto* packet = std::get_if<synaptic::send_on_channel>(&each)) {
      channels_.send(packet->channel, std::move(packet->octets), packet->in_slot);
    } else if (const auto* over = std::get_if<synaptic::disconnect>(&each)) {
      channels_.disconnect(over->channel);
    } else if (const auto* done = std::get_if<synaptic::create_done>(&each)) {
      programs_.notify_owner(owners_, done->channel, [x = *done](auto& events) {
        if (x.is_out)
          events.createSynChannelOutDone(x.channel.value, status_of(x.success));
        else
          events.createSynChannelInDone(x.channel.value, status_of(x.success));
      });
      if (!done->success)
        owners_.erase(done->channel);
    } else if (const auto* update = std::get_if<synaptic::input_update>(&each)) {
      programs_.notify_owner(owners_, update->channel, [x = *update](auto& events) {
        events.syn_input_update(x.channel.value, x.index, x.status);
      });
    } else {
      const auto failed = std::get<synaptic::channel_failed>(each).channel;
      programs_.notify_owner(owners_, failed,
                             [failed](auto& events) { events.synChannelFailed(failed.value); });
    }
  }
}

} // namespace rubicon::communication
