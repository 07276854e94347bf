#include "apps/synapses.hpp"

#include <algorithm>

namespace rubicon::apps {

namespace {

constexpr duration pause = 3s; ///< before a channel is created anew

} // namespace

synapses::synapses(const std::vector<synapse>& from, const std::vector<synapse>& to) {
  for (const auto& x : from)
    ends_.push_back({x, false});
  for (const auto& x : to)
    ends_.push_back({x, true});
}

void synapses::open_all(mote::communication& layer) {
  retry_.reset();
  for (auto& x : ends_) {
    if (x.channel > 0)
      continue;
    x.channel = x.is_out ? layer.create_syn_channel_out(x.what.other, x.what.size, {})
                         : layer.create_syn_channel_in(x.what.other, x.what.size, {});
    if (x.channel < 0)
      retry_ = layer.now() + pause;
  }
}

void synapses::close_all(mote::communication& layer) {
  retry_.reset();
  for (auto& x : ends_) {
    if (x.channel > 0)
      layer.dispose_syn_channel(x.channel);
    x.channel = -1;
    x.is_open = false;
  }
}

void synapses::on_created(mote::communication& layer, int channel, bool success) {
  const auto x = std::ranges::find(ends_, channel, &end::channel);
  if (x == ends_.end())
    return;
  x->is_open = success;
  if (success) {
    if (x->is_out)
      layer.start_syn_channel(channel);
    return;
  }
  ++failures_;
  x->channel = -1;
  retry_ = layer.now() + pause;
}

void synapses::on_failed(mote::communication& layer, int channel) {
  const auto x = std::ranges::find(ends_, channel, &end::channel);
  if (x == ends_.end())
    return;
  ++failures_;
  layer.dispose_syn_channel(channel);
  x->channel = -1;
  x->is_open = false;
  retry_ = layer.now() + pause;
}

void synapses::on_time(mote::communication& layer, instant now) {
  if (retry_ && *retry_ <= now)
    open_all(layer);
}

bool synapses::all_open() const {
  return std::ranges::all_of(ends_, &end::is_open);
}

} // namespace rubicon::apps
