#include "peis/udp/udp_send_window.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::peis {

void udp_send_window::add(bytes content) {
  parts_.push_back({std::move(content), 0, {}, state::lost});
  ++lost_;
}

udp_send_window::transmission udp_send_window::transmit(std::uint64_t sequence, instant now) {
  auto& x = parts_[sequence - first_];
  assert(x.now != state::arrived);
  const bool is_repeated = x.number != 0;
  if (x.now == state::lost) {
    --lost_;
    ++under_way_;
  }
  x.now = state::under_way;
  if (static_cast<std::uint32_t>(++sent_) == 0)
    ++sent_; // it would say that there is no part
  x.number = sent_;
  x.sent = now;
  return {x.number, x.content, is_repeated};
}

bool udp_send_window::is_possible(const udp_segment& x) const {
  return x.expected <= next() && widened(x.newest, sent_) <= sent_;
}

udp_send_window::news udp_send_window::on_report(const udp_segment& x) {
  const auto newest = widened(x.newest, sent_);
  if (newest < newest_ || x.newest == 0)
    return news::none;
  const auto what = newest > newest_ ? news::newer : news::same;
  newest_ = newest;
  count_ = std::max(count_, widened(x.count, newest));
  return what;
}

void udp_send_window::note_arrival(part& x, instant now, acknowledged& out) {
  if (x.now == state::arrived)
    return;
  if (x.number == newest_)
    out.round_trip = now - x.sent;
  if (x.now == state::under_way)
    --under_way_;
  else
    --lost_;
  x.now = state::arrived;
  out.octets += x.content.size();
}

udp_send_window::acknowledged udp_send_window::acknowledge(const udp_segment& x, instant now) {
  acknowledged out;
  for (; first_ < x.expected; ++first_) {
    note_arrival(parts_.front(), now, out);
    parts_.pop_front();
  }
  if (x.number != 0)
    return out;
  for (std::size_t i = 0; i < 8 * x.content.size(); ++i) {
    const auto sequence = x.expected + 1 + i;
    const bool has_come = (x.content[i / 8] >> (7 - i % 8) & 1) != 0;
    if (has_come && sequence >= first_ && sequence < next())
      note_arrival(parts_[sequence - first_], now, out);
  }
  return out;
}

void udp_send_window::find_losses(instant now, duration lost_after) {
  loss_at_.reset();
  if (under_way_ == 0)
    return;
  for (auto& x : parts_) {
    if (x.now != state::under_way || x.number >= newest_)
      continue;
    if (x.sent + lost_after <= now) {
      x.now = state::lost;
      --under_way_;
      ++lost_;
    } else {
      loss_at_ = earliest(loss_at_, x.sent + lost_after);
    }
  }
}

udp_send_window::state udp_send_window::state_of(std::uint64_t sequence) const {
  return parts_[sequence - first_].now;
}

} // namespace rubicon::peis
