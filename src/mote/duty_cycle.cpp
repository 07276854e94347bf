#include "mote/duty_cycle.hpp"

#include <algorithm>
#include <limits>

#include "core/codec.hpp"
#include "network/am.hpp"

namespace rubicon::mote {

namespace {

using std::chrono::microseconds;

constexpr std::uint64_t window_key = std::numeric_limits<std::uint64_t>::max();
constexpr int window_share = 4; ///< frames set out in the first three quarters of a window

microseconds in_us(duration x) {
  return std::chrono::duration_cast<microseconds>(x);
}

/// Adds how long a frame has waited here to the age of the time in it.
void grow_older(network::frame_out& x, duration by) {
  const auto field = std::span(x.payload).subspan(*x.age_at, 4);
  byte_writer age;
  age.big(byte_reader(field).big<std::uint32_t>() + static_cast<std::uint32_t>(by / 1us));
  std::ranges::copy(age.finish(), field.begin());
}

/// The channel whose packet a frame carries.
std::optional<network::channel_id> channel_in(const network::frame_out& x) {
  if (x.am_type != network::am::channel)
    return std::nullopt;
  const auto message = network::decode_channel_message(x.payload);
  if (!message || !std::holds_alternative<network::data_message>(message->content))
    return std::nullopt;
  return message->channel;
}

} // namespace

void duty_cycle::reserve(const network::channel_reserved& x) {
  const auto key = network::number_of(x.channel);
  const auto interval = in_us(x.schedule.interval);
  if (interval <= in_us(config_.before + config_.after)) { // as good as always
    channels_.erase(x.channel);
    schedule_.remove(key);
    return;
  }
  channels_[x.channel] = x;
  schedule_.set(key, {x.schedule.first, interval, in_us(config_.before), in_us(config_.after)});
}

void duty_cycle::on_sent(std::uint64_t token, instant now) {
  const auto sent = under_way_.extract(token);
  if (!sent.empty() && sent.mapped())
    served_.emplace_back(now, *sent.mapped());
}

void duty_cycle::on_received(network::channel_id channel, instant now) {
  served_.emplace_back(now + config_.linger, channel);
}

std::optional<instant> duty_cycle::next_turn(network::channel_id channel, instant now,
                                             const network::clock_sync& clock) const {
  const auto found = channels_.find(channel);
  if (found == channels_.end() || found->second.previous || !has_turns(now, clock))
    return std::nullopt;
  const auto& schedule = found->second.schedule;
  const microseconds interval = schedule.interval;
  const auto since = clock.at(now) - schedule.first;
  const auto turns = since.count() < 0 ? 0 : since / interval + 1;
  return clock.when(schedule.first + turns * interval);
}

/// Whether others may be asleep.
bool duty_cycle::has_turns(instant now, const network::clock_sync& clock) const {
  return config_.enabled && clock.synchronised() &&
         clock.at(now) >= island_time(in_us(config_.settling));
}

/// The channel to whose schedule a frame keeps. What goes back to a channel's source keeps to none.
std::optional<network::channel_id> duty_cycle::schedule_of(const network::frame_out& x) const {
  const auto channel = channel_in(x);
  const auto found = channel ? channels_.find(*channel) : channels_.end();
  if (found == channels_.end() || found->second.previous == x.next_hop)
    return std::nullopt;
  return channel;
}

/// When a frame without a schedule may go: now, if all are on.
instant duty_cycle::turn_of(instant now, const network::clock_sync& clock) {
  const auto time = clock.at(now).time_since_epoch();
  const auto period = in_us(config_.period);
  const auto into = (time % period + period) % period;
  const auto open = in_us(config_.window) * (window_share - 1) / window_share;
  if (into < open)
    return now;
  const auto offset = in_us(dice_.between(0s, config_.window)) / 2;
  return clock.when(island_time(time - into + period + offset));
}

void duty_cycle::release(held x, duty_outputs& out, instant now) {
  if (x.frame.age_at)
    grow_older(x.frame, now - x.since);
  under_way_[x.frame.token] = x.channel;
  out.emplace_back(std::move(x.frame));
}

duty_outputs duty_cycle::update(instant now, const network::clock_sync& clock) {
  duty_outputs out;
  due_.reset();
  const bool waits = has_turns(now, clock);
  std::vector<held> ready;
  for (auto x = held_.begin(); x != held_.end();) {
    if (!x->due) {
      if (config_.enabled)
        x->channel = schedule_of(x->frame);
      x->due = !waits || x->channel ? now : turn_of(now, clock);
      counters_.held += *x->due > now ? 1 : 0;
    }
    if (*x->due > now && held_.size() > config_.held_max) {
      ++counters_.overflow;
      x->due = now;
    }
    if (*x->due > now && waits) {
      due_ = earliest(due_, x->due);
      ++x;
      continue;
    }
    ready.push_back(std::move(*x));
    x = held_.erase(x);
  }
  switch_radio(!ready.empty(), out, now, clock);
  for (auto& x : ready)
    release(std::move(x), out, now);
  return out;
}

void duty_cycle::switch_radio(bool sends, duty_outputs& out, instant now,
                              const network::clock_sync& clock) {
  const bool may_sleep = !is_sink_ && is_member_ && has_turns(now, clock);
  bool on = true;
  if (may_sleep) {
    const auto time = clock.at(now);
    schedule_.set(window_key, {island_time{}, in_us(config_.period), in_us(config_.before),
                               in_us(config_.window)});
    std::erase_if(served_, [&](const auto& x) {
      if (x.first > now)
        return false;
      schedule_.served(network::number_of(x.second), time);
      return true;
    });
    on = schedule_.is_on(time) || !under_way_.empty() || sends;
    if (const auto next = schedule_.next_change(time))
      due_ = earliest(due_, std::max(clock.when(*next), now + 1us));
    for (const auto& x : served_)
      due_ = earliest(due_, x.first);
  } else {
    served_.clear();
  }
  if (on != on_)
    out.emplace_back(radio_switch{on});
  on_ = on;
}

} // namespace rubicon::mote
