#include "communication/remote/remote_channels.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace rubicon::communication {

int remote_channels::create(bool is_out, mote_address other, std::uint8_t size,
                            const synaptic::parameters& params) {
  const auto is_equal = [&, to = resolved(exchange_, other, params.island)](const auto& x) {
    return x.second.is_out == is_out && x.second.other == to && x.second.at != phase::ended;
  };
  const auto used = std::ranges::count_if(
      channels_.all(), [is_out](const auto& x) { return x.second.is_out == is_out; });
  if (!exchange_.may_send() || other.mote == broadcast_mote || size == 0 ||
      size > exchange_.node().vector_max || std::ranges::any_of(channels_.all(), is_equal) ||
      used >= exchange_.node().channels_max || !exchange_.has_room()) {
    exchange_.refuse();
    return -1;
  }
  row added;
  added.is_out = is_out;
  added.other = resolved(exchange_, other, params.island);
  added.values.resize(size);
  const auto id = channels_.add(std::move(added));
  exchange_.command(remote::create_channel{id, is_out, other, size, params});
  return id;
}

void remote_channels::report_created(std::uint16_t channel, bool is_out, bool success) {
  exchange_.notify([=](auto& x) {
    if (is_out)
      x.createSynChannelOutDone(channel, status_of(success));
    else
      x.createSynChannelInDone(channel, status_of(success));
  });
}

status remote_channels::dispose(int channel) {
  const auto* x = channels_.find(channel);
  if (x == nullptr)
    return exchange_.refuse();
  const auto id = static_cast<std::uint16_t>(channel);
  if (x->at == phase::opening)
    report_created(id, x->is_out, false);
  channels_.erase(id);
  exchange_.command(remote::dispose_channel{id});
  return SUCCESS;
}

remote_channels::row* remote_channels::open_channel(int channel, bool is_out) {
  auto* x = channels_.find(channel);
  return x != nullptr && x->is_out == is_out && x->at == phase::open ? x : nullptr;
}

status remote_channels::start(int channel) {
  auto* x = open_channel(channel, true);
  if (x == nullptr || !exchange_.has_room())
    return exchange_.refuse();
  x->is_active = true;
  exchange_.command(remote::start_channel{static_cast<std::uint16_t>(channel)});
  return SUCCESS;
}

status remote_channels::stop(int channel) {
  auto* x = open_channel(channel, true);
  if (x == nullptr || !x->is_active || !exchange_.has_room())
    return exchange_.refuse();
  x->is_active = false;
  exchange_.command(remote::stop_channel{static_cast<std::uint16_t>(channel)});
  return SUCCESS;
}

/// Elements that are written one after the other make one command.
status remote_channels::write_output(int channel, std::uint8_t k, float value) {
  auto* x = open_channel(channel, true);
  if (x == nullptr || k >= x->values.size())
    return exchange_.refuse();
  auto* last = std::get_if<remote::set_outputs>(exchange_.last_command());
  const bool goes_on = last != nullptr && last->channel == channel;
  if (!goes_on && !exchange_.has_room())
    return exchange_.refuse();
  x->values[k] = value;
  if (goes_on)
    last->values[k] = value;
  else
    exchange_.command(remote::set_outputs{static_cast<std::uint16_t>(channel), x->values});
  return SUCCESS;
}

float remote_channels::read_input(int channel, std::uint8_t index) {
  const auto* x = open_channel(channel, false);
  if (x != nullptr && index < x->values.size())
    return x->values[index];
  exchange_.count_bad_read();
  return std::numeric_limits<float>::quiet_NaN();
}

void remote_channels::apply(const remote::channel_created& x) {
  auto* found = channels_.find(x.channel);
  if (found == nullptr) // disposed of in the meantime, and reported
    return;
  if (x.success)
    found->at = phase::open;
  else
    channels_.erase(x.channel);
  report_created(x.channel, x.is_out, x.success);
}

void remote_channels::apply(const remote::inputs_shown& x) {
  auto* found = channels_.find(x.channel);
  if (found == nullptr || found->values.size() != x.values.size())
    return;
  found->values = x.values;
  const auto how = x.updated ? synaptic::input_status::updated : synaptic::input_status::missed;
  for (std::size_t i = 0; i < x.values.size(); ++i)
    exchange_.notify([channel = x.channel, i, how](auto& y) {
      y.syn_input_update(channel, static_cast<std::uint8_t>(i), how);
    });
}

void remote_channels::apply(const remote::channel_failed& x) {
  auto* found = channels_.find(x.channel);
  if (found == nullptr)
    return;
  found->at = phase::ended;
  found->is_active = false;
  exchange_.notify([channel = x.channel](auto& y) { y.synChannelFailed(channel); });
}

void remote_channels::apply(const remote::ticked& x) {
  exchange_.notify([tick = x.tick](auto& y) { y.clock_tick(tick); });
}

} // namespace rubicon::communication
