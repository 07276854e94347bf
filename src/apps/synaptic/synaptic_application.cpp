#include "apps/synaptic/synaptic_application.hpp"

#include <algorithm>

namespace rubicon::apps {

namespace {

constexpr duration create_pause = 3s; ///< before a channel is created anew

} // namespace

synaptic_application::synaptic_application(const std::vector<synapse>& from,
                                           const std::vector<synapse>& to) {
  for (const auto& x : from)
    ends_.push_back({x, false});
  for (const auto& x : to)
    ends_.push_back({x, true});
}

void synaptic_application::joined(communication::island_octet, std::uint16_t,
                                  communication::status success) {
  close_all();
  if (success == communication::SUCCESS)
    open_all();
}

void synaptic_application::open_all() {
  retry_.reset();
  for (auto& x : ends_) {
    if (x.channel > 0)
      continue;
    x.channel = x.is_out ? layer().create_syn_channel_out(x.what.other, x.what.size, {})
                         : layer().create_syn_channel_in(x.what.other, x.what.size, {});
    if (x.channel < 0)
      retry_ = layer().now() + create_pause;
  }
}

void synaptic_application::close_all() {
  retry_.reset();
  for (auto& x : ends_) {
    if (x.channel > 0)
      layer().dispose_syn_channel(x.channel);
    x.channel = -1;
    x.is_open = false;
  }
}

void synaptic_application::createSynChannelOutDone(int channel, communication::status success) {
  on_created(channel, success == communication::SUCCESS);
}

void synaptic_application::createSynChannelInDone(int channel, communication::status success) {
  on_created(channel, success == communication::SUCCESS);
}

void synaptic_application::on_created(int channel, bool success) {
  const auto x = std::ranges::find(ends_, channel, &end::channel);
  if (x == ends_.end())
    return;
  if (!success) {
    lose(*x);
    return;
  }
  x->is_open = true;
  if (x->is_out)
    layer().start_syn_channel(channel);
}

void synaptic_application::synChannelFailed(int channel) {
  const auto x = std::ranges::find(ends_, channel, &end::channel);
  if (x == ends_.end())
    return;
  layer().dispose_syn_channel(channel);
  lose(*x);
}

void synaptic_application::lose(end& x) {
  ++losses_;
  x.channel = -1;
  x.is_open = false;
  retry_ = layer().now() + create_pause;
}

void synaptic_application::on_time(instant now) {
  if (retry_ && *retry_ <= now)
    open_all();
}

void synaptic_application::syn_input_update(int, std::uint8_t index,
                                            synaptic::input_status status) {
  if (index == 0)
    ++(status == synaptic::input_status::updated ? updated_ : missed_);
}

bool synaptic_application::all_open() const {
  return std::ranges::all_of(ends_, &end::is_open);
}

std::vector<figure> synaptic_application::figures() const {
  return {{"ticks", static_cast<double>(ticks_)},
          {"vectors updated", static_cast<double>(updated_)},
          {"vectors missed", static_cast<double>(missed_)},
          {"channels lost", static_cast<double>(losses_)}};
}

} // namespace rubicon::apps
