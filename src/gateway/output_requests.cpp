#include "gateway/output_requests.hpp"

#include <algorithm>
#include <utility>

#include "core/tuples/device_keys.hpp"

namespace rubicon::gateway {

namespace {

/// Every channel, and as many periods as there is room for.
void shorten(output_requests::wanted& all) {
  std::erase_if(all, [](const auto& x) {
    return x.channel == communication::any_channel || x.period == std::chrono::milliseconds{};
  });
  all.resize(std::min(all.size(), communication::outputs_wanted_max - 1));
  all.push_back({communication::any_channel, {}});
}

} // namespace

output_requests::output_requests(output_requests_config config, bool restarted, instant now)
    : config_(config), restarted_(restarted),
      withheld_until_(restarted ? now + config.restart_pause : now) {}

void output_requests::on_subscribers(std::span<const std::string> keys, instant now) {
  channels_.clear();
  channels_of_all_.clear();
  for (const auto& text : keys) {
    if (const auto pattern = parse_output_pattern(text)) {
      auto& channels = pattern->mote ? channels_[*pattern->mote] : channels_of_all_;
      channels.insert(pattern->channel.value_or(communication::any_channel));
    }
  }
  review_all(now + config_.hesitation);
}

void output_requests::on_period(mote_id mote, std::uint16_t channel,
                                std::chrono::milliseconds period, instant now) {
  const auto found = motes_.find(mote);
  if (found == motes_.end() || !found->second.listed)
    return;
  if (period.count() > 0)
    periods_[{mote, channel}] = period;
  else
    periods_.erase({mote, channel});
  review(mote, found->second, now + config_.hesitation);
}

void output_requests::on_listed(mote_id mote, std::uint32_t incarnation, instant now) {
  const auto [at, is_new] = motes_.try_emplace(mote);
  auto& x = at->second;
  x.listed = true;
  if (x.incarnation != incarnation || (is_new && !restarted_))
    x.confirmed = wanted{};
  x.incarnation = incarnation;
  review(mote, x, now + config_.hesitation);
}

void output_requests::on_unlisted(mote_id mote) {
  const auto found = motes_.find(mote);
  if (found == motes_.end())
    return;
  found->second.listed = false;
  schedule(mote, found->second, std::nullopt);
}

void output_requests::forget_confirmed(instant now) {
  in_flight_ = 0;
  for (auto& [mote, x] : motes_) {
    x.confirmed.reset();
    x.in_flight.reset();
  }
  review_all(now);
}

std::vector<output_requests::request> output_requests::due(instant now) {
  std::vector<request> all;
  while (in_flight_ < config_.in_flight_max && !due_.empty() && due_.begin()->first <= now) {
    const auto mote = due_.begin()->second;
    auto& x = motes_.at(mote);
    schedule(mote, x, std::nullopt);
    x.in_flight = wanted_of(mote);
    x.asked = x.incarnation;
    ++in_flight_;
    all.push_back({mote, *x.in_flight});
  }
  return all;
}

void output_requests::on_outcome(mote_id mote, bool acked, instant now) {
  const auto found = motes_.find(mote);
  if (found == motes_.end() || !found->second.in_flight)
    return;
  auto& x = found->second;
  --in_flight_;
  auto sent = std::exchange(x.in_flight, std::nullopt);
  if (acked && x.asked == x.incarnation)
    x.confirmed = std::move(sent);
  else if (!acked)
    x.confirmed.reset();
  review(mote, x, acked ? now : now + config_.retry);
}

std::optional<instant> output_requests::deadline() const {
  if (due_.empty() || in_flight_ == config_.in_flight_max)
    return std::nullopt;
  return due_.begin()->first;
}

output_requests::wanted output_requests::wanted_of(mote_id mote) const {
  auto channels = channels_of_all_;
  if (const auto own = channels_.find(mote); own != channels_.end())
    channels.insert(own->second.begin(), own->second.end());
  for (auto x = periods_.lower_bound({mote, 0}); x != periods_.end() && x->first.first == mote;
       ++x) {
    if (channels.contains(communication::any_channel))
      channels.insert(x->first.second); // to say how often
  }
  wanted all;
  for (const auto channel : channels) {
    const auto period = periods_.find({mote, channel});
    all.push_back(
        {channel, period == periods_.end() ? std::chrono::milliseconds{} : period->second});
  }
  if (all.size() > communication::outputs_wanted_max)
    shorten(all);
  return all;
}

/// @param at when to ask, unless the mote knows already
void output_requests::review(mote_id mote, entry& x, instant at) {
  if (!x.listed || x.in_flight)
    return;
  if (x.confirmed && *x.confirmed == wanted_of(mote))
    schedule(mote, x, std::nullopt);
  else if (!x.due)
    schedule(mote, x, std::max(at, withheld_until_));
}

void output_requests::schedule(mote_id mote, entry& x, std::optional<instant> at) {
  if (x.due)
    due_.erase({*x.due, mote});
  x.due = at;
  if (at)
    due_.insert({*at, mote});
}

void output_requests::review_all(instant at) {
  for (auto& [mote, x] : motes_)
    review(mote, x, at);
}

} // namespace rubicon::gateway
