#include "radio/mac.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::radio {

std::string to_string(send_status x) {
  switch (x) {
  case send_status::sent:
    return "sent";
  case send_status::no_ack:
    return "no_ack";
  case send_status::channel_access_failure:
    return "channel_access_failure";
  case send_status::queue_full:
    return "queue_full";
  case send_status::aborted:
    return "aborted";
  }
  return "unknown";
}

void mac::submit(outgoing x, instant now, random_stream& dice) {
  assert(!full());
  open_.push(std::move(x));
  if (state_ == state::idle)
    attempt(now, dice);
}

mac_action mac::on_time(instant now, bool clear, random_stream& dice) {
  if (!deadline_ || now < *deadline_)
    return {};
  switch (state_) {
  case state::backing_off:
    if (clear) {
      state_ = state::turning;
      deadline_ = now + timing::turnaround;
      return {};
    }
    if (++busy_ > timing::backoffs_max)
      return finish(send_status::channel_access_failure, now, dice);
    back_off(now, dice);
    return {};
  case state::turning:
    state_ = state::sending;
    deadline_.reset();
    ++open_.front().transmissions;
    return {.transmit = true, .ended = {}};
  case state::ack_wait:
    if (open_.front().transmissions > retries_max_)
      return finish(send_status::no_ack, now, dice);
    attempt(now, dice);
    return {};
  case state::idle:
  case state::sending:
    break; // no deadline
  }
  return {};
}

mac_action mac::on_sent(instant now, random_stream& dice) {
  assert(state_ == state::sending);
  leave_space(now);
  if (!open_.front().content.ack_request)
    return finish(send_status::sent, now, dice);
  state_ = state::ack_wait;
  deadline_ = now + timing::ack_wait;
  return {};
}

mac_action mac::on_ack(instant now, random_stream& dice) {
  assert(state_ == state::ack_wait);
  // IEEE 802.15.4-2006 7.5.1.3: an acked frame's space is counted from the end of its ack.
  leave_space(now);
  return finish(send_status::sent, now, dice);
}

std::vector<finished> mac::abort() {
  std::vector<finished> all;
  while (!open_.empty()) {
    const auto x = open_.pop();
    all.push_back({x.token, send_status::aborted, x.transmissions});
  }
  state_ = state::idle;
  deadline_.reset();
  return all;
}

void mac::leave_space(instant now) {
  const bool is_short = open_.front().psdu.size() <= timing::sifs_psdu_max;
  free_from_ = now + (is_short ? timing::sifs : timing::lifs);
}

void mac::attempt(instant now, random_stream& dice) {
  busy_ = 0;
  back_off(std::max(now, free_from_), dice);
}

void mac::back_off(instant from, random_stream& dice) {
  const auto exponent = std::min(timing::be_min + busy_, timing::be_max);
  const auto units = static_cast<duration::rep>(dice.below(1ULL << exponent));
  state_ = state::backing_off;
  deadline_ = from + units * timing::unit_backoff + timing::cca;
}

mac_action mac::finish(send_status status, instant now, random_stream& dice) {
  const auto x = open_.pop();
  state_ = state::idle;
  deadline_.reset();
  if (!open_.empty())
    attempt(now, dice);
  return {.transmit = false, .ended = finished{x.token, status, x.transmissions}};
}

} // namespace rubicon::radio
