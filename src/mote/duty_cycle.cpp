#include "mote/duty_cycle.hpp"

#include <algorithm>
#include <limits>

#include "network/am.hpp"

namespace rubicon::mote {

namespace {

using std::chrono::microseconds;

constexpr std::uint64_t window_key = std::numeric_limits<std::uint64_t>::max();

/// The channel whose packet a frame carries.
std::optional<network::channel_id> channel_in(std::uint8_t am_type, byte_view payload) {
  if (am_type != network::am::channel)
    return std::nullopt;
  const auto message = network::decode_channel_message(payload);
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
  channels_[x.channel].reserved = x;
  schedule_.set(key, {x.schedule.first, interval, in_us(config_.before), in_us(config_.after)});
}

void duty_cycle::on_sent(std::uint64_t token) {
  const auto sent = in_flight_.extract(token);
  if (sent && *sent)
    served_.push_back(**sent);
}

void duty_cycle::on_frame(std::uint8_t am_type, byte_view payload, instant now) {
  if (channels_.empty())
    return;
  const auto channel = channel_in(am_type, payload);
  if (const auto found = channel ? channels_.find(*channel) : channels_.end();
      found != channels_.end())
    found->second.repeats_until = now + config_.linger;
}

instant duty_cycle::repeats_until(network::channel_id channel) const {
  const auto found = channels_.find(channel);
  return found == channels_.end() ? instant{} : found->second.repeats_until;
}

microseconds duty_cycle::guard(instant now, const network::time_estimate& clock) const {
  return 2 * clock.doubt(now + config_.period);
}

/// When this mote hands on the next packet of a channel.
instant duty_cycle::next_departure(const network::channel_reserved& x, instant now,
                                   const network::time_estimate& clock) const {
  const microseconds interval = x.schedule.interval;
  const auto first = x.schedule.first + (x.previous ? network::channel_slot : microseconds{});
  const auto turns = period_number(clock.at(now) - first - microseconds{1}, interval) + 1;
  return clock.when(first + turns * interval);
}

std::optional<instant> duty_cycle::next_turn(network::channel_id channel, instant now,
                                             const network::time_estimate& clock) const {
  const auto found = channels_.find(channel);
  if (found == channels_.end() || found->second.reserved.previous || !applies(now, clock))
    return std::nullopt;
  return next_departure(found->second.reserved, now, clock);
}

/// Now, unless the next mote wakes up for this packet a little later. What goes back to a channel's
/// source keeps to no schedule, nor does what goes in a common window.
instant duty_cycle::departure(const held& x, instant now,
                              const network::time_estimate& clock) const {
  const auto found = x.channel ? channels_.find(*x.channel) : channels_.end();
  if (found == channels_.end() || found->second.reserved.previous == x.frame.next_hop ||
      !applies(now, clock))
    return now;
  const auto into = clock.at(now).time_since_epoch() % in_us(config_.period);
  if (into >= microseconds{} && into < in_us(config_.window))
    return now;
  // One that has come through a window is far ahead of its time; who is late has missed half a
  // turn.
  const auto& reserved = found->second.reserved;
  const auto next = next_departure(reserved, now, clock);
  return next - now <= reserved.schedule.interval / 2 ? next : now;
}

duty_outputs duty_cycle::update(instant now, const network::time_estimate& clock,
                                const network::time_search& search) {
  duty_outputs out;
  due_.reset();
  std::vector<held> ready;
  for (auto x = held_.begin(); x != held_.end();) {
    if (!x->due) {
      if (config_.enabled)
        x->channel = channel_in(x->frame.am_type, x->frame.payload);
      x->due = departure(*x, now, clock);
    }
    if (*x->due > now) {
      due_ = earliest(due_, x->due);
      ++x;
      continue;
    }
    ready.push_back(std::move(*x));
    x = held_.erase(x);
  }
  switch_radio(!ready.empty(), out, now, clock, search);
  for (auto& x : ready) {
    in_flight_[x.frame.token] = x.channel;
    out.emplace_back(std::move(x.frame));
  }
  return out;
}

/// Whether a window or a channel needs the radio now; it may be another when due_ comes.
bool duty_cycle::is_due(instant now, const network::time_estimate& clock) {
  const auto time = clock.at(now);
  const auto margin = guard(now, clock);
  schedule_.set(window_key, {island_time{}, in_us(config_.period), in_us(config_.before),
                             in_us(config_.window)});
  std::erase_if(served_, [&](network::channel_id x) {
    if (repeats_until(x) > now)
      return false;
    schedule_.served(network::number_of(x), time, margin);
    return true;
  });
  if (const auto next = schedule_.next_change(time, margin))
    due_ = earliest(due_, clock.when(*next));
  for (const auto x : served_)
    due_ = earliest(due_, repeats_until(x));
  return schedule_.is_on(time, margin);
}

void duty_cycle::switch_radio(bool sends, duty_outputs& out, instant now,
                              const network::time_estimate& clock,
                              const network::time_search& search) {
  const bool has_windows = applies(now, clock);
  bool on = true;
  if (!is_sink_ && (search.rests() || (is_member_ && has_windows))) {
    const bool is_needed = has_windows && is_due(now, clock);
    on = is_needed || search.listens(now) || !in_flight_.empty() || sends;
    due_ = earliest(due_, search.listen_end(now));
  } else {
    served_.clear();
  }
  if (on != on_)
    out.emplace_back(radio_switch{on});
  on_ = on;
}

} // namespace rubicon::mote
