#include "mote/stack/slot_client.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::mote {

namespace {

constexpr duration notice_spread = 500ms;
constexpr duration notice_period = 60s;
constexpr duration grant_wait = 2s;    ///< beside turns
constexpr duration connect_wait = 10s; ///< for channels that come about one after the other

} // namespace

void slot_client::on_joined() {
  granted_ = {};
  units_ = 0;
}

void slot_client::on_lost() {
  granted_ = {};
  notice_at_.reset();
}

void slot_client::on_grant(const network::slot_run& x, random_stream& rng, instant now) {
  granted_ = x;
  if (notice_at_ && (granted_.units == units_ || granted_.units == 0))
    notice_at_ = next_notice(rng, now);
}

/// Nothing while there is nothing to request.
std::optional<instant> slot_client::next_notice(random_stream& rng, instant now) const {
  return units_ > 0 ? std::optional(now + notice_period - rng.between(0s, notice_period / 4))
                    : std::nullopt;
}

void slot_client::set_demand(std::uint16_t units, bool all_connected, random_stream& rng,
                             instant now) {
  if (all_connected)
    counts_at_.reset();
  else if (!counts_at_)
    counts_at_ = now + connect_wait;
  if (counts_at_ && now < *counts_at_)
    return;
  if (std::exchange(units_, units) != units)
    notice_at_ = now + rng.between(0s, notice_spread);
}

std::optional<slot_notice> slot_client::take_notice(duration answer_wait, random_stream& rng,
                                                    instant now) {
  if (!notice_at_ || *notice_at_ > now)
    return std::nullopt;
  notice_at_.reset();
  if (granted_.units == units_) // the sink answers to what it does not agree with
    notice_at_ = next_notice(rng, now);
  else if (units_ > 0)
    notice_at_ = now + grant_wait + answer_wait;
  return slot_notice{units_, granted_};
}

std::optional<instant> slot_client::take(duration passage, duration space, instant now) {
  if (left_ + space < passage)
    return std::nullopt;
  left_ -= passage;
  const auto begin = std::max(now, at_);
  at_ = begin + passage;
  return begin;
}

std::optional<slot_client::packet> slot_client::next(instant now) {
  if (delayed_.empty() || delayed_.front().due > now)
    return std::nullopt;
  auto first = std::move(delayed_.front().what);
  delayed_.erase(delayed_.begin());
  return first;
}

std::optional<instant> slot_client::deadline() const {
  return delayed_.empty() ? notice_at_ : earliest(notice_at_, std::optional(delayed_.front().due));
}

} // namespace rubicon::mote
