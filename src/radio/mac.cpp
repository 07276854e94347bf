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

void mac::submit(outgoing x, instant now, random_stream& rng) {
  assert(!full());
  open_.push(std::move(x));
  if (state_ == state::idle)
    take_up(now, rng);
}

mac_action mac::on_time(instant now, bool clear, random_stream& rng) {
  if (!deadline_ || now < *deadline_)
    return {};
  switch (state_) {
  case state::backing_off:
  case state::looking_again:
    return on_assessed(now, clear, rng);
  case state::turning:
    state_ = state::sending;
    deadline_.reset();
    if (++open_.front().transmissions == 1)
      train_end_ = now + train_;
    return {.transmit = true, .ended = {}};
  case state::ack_wait:
    if (repeats())
      return again(now, rng);
    if (open_.front().in_slot || open_.front().transmissions > retries_max_)
      return finish(send_status::no_ack, now, rng);
    attempt(now, rng);
    return {};
  case state::idle:
  case state::sending:
    break; // no deadline
  }
  return {};
}

mac_action mac::on_assessed(instant now, bool clear, random_stream& rng) {
  if (train_is_over(now))
    return end_train(now, rng);
  if (clear) {
    const bool again = state_ == state::backing_off && rules_->second_look > 0s;
    state_ = again ? state::looking_again : state::turning;
    deadline_ = now + (again ? rules_->second_look : rules_->turnaround);
    return {};
  }
  if (open_.front().in_slot)
    return finish(send_status::channel_access_failure, now, rng);
  ++busy_;
  if (!repeats() && rules_->assessments_max != 0 && busy_ >= rules_->assessments_max) {
    if (++rounds_ >= rules_->rounds_max)
      return finish(send_status::channel_access_failure, now, rng);
    busy_ = 0;
  }
  begin(now, rng);
  return {};
}

mac_action mac::on_sent(instant now, random_stream& rng) {
  assert(state_ == state::sending);
  assess_from_ = now + timing::turnaround;
  leave_space(now);
  if (!open_.front().content.ack_request)
    return repeats() ? again(now, rng) : finish(send_status::sent, now, rng);
  state_ = state::ack_wait;
  deadline_ = now + rules_->ack_wait;
  return {};
}

void mac::on_own_ack(instant until, random_stream& rng) {
  assess_from_ = std::max(assess_from_, until + timing::turnaround); // 6.9.2: deaf until then
  free_from_ = std::max(free_from_, assess_from_);
  if (assesses())
    attempt(free_from_, rng);
}

mac_action mac::on_ack(instant now, random_stream& rng) {
  assert(state_ == state::ack_wait);
  // IEEE 802.15.4-2006 7.5.1.3: an acked frame's space is counted from the end of its ack.
  assess_from_ = std::max(assess_from_, now);
  leave_space(now);
  return finish(send_status::sent, now, rng);
}

instant mac::earliest_output() const {
  if (state_ == state::turning)
    return *deadline_ + air_time(open_.front().psdu.size());
  if (repeats())
    return earliest_output_of_train();
  if (!assesses() || open_.front().in_slot)
    return *deadline_;
  if (rules_->assessments_max == 0)
    return earliest_output_if_clear();
  const auto further = rules_->assessments_max * (rules_->rounds_max - rounds_) - busy_ - 1;
  const auto shortest = rules_->backoffs.back().first + rules_->assessment;
  return std::min(earliest_output_if_clear(), *deadline_ + further * shortest);
}

/// A copy that ends, or the end of the train: whichever can come first.
instant mac::earliest_output_of_train() const {
  if (assesses())
    return std::min(earliest_output_if_clear(), std::max(*deadline_, train_end_));
  const auto assessed = *deadline_ + copy_backoff.first + rules_->assessment;
  const auto copied = assessed + rules_->turnaround + air_time(open_.front().psdu.size());
  return train_is_over(*deadline_) ? *deadline_ : std::min(copied, std::max(assessed, train_end_));
}

instant mac::earliest_output_if_clear() const {
  if (train_is_over(*deadline_))
    return *deadline_;
  return *deadline_ + rules_->turnaround + air_time(open_.front().psdu.size());
}

std::vector<finished> mac::abort() {
  std::vector<finished> all;
  while (!open_.empty()) {
    const auto x = open_.pop();
    all.push_back({x.token, send_status::aborted, counted(x.transmissions), x.arrived, x.last,
                   x.from, false});
  }
  state_ = state::idle;
  deadline_.reset();
  return all;
}

void mac::leave_space(instant now) {
  if (!rules_->spaces)
    return;
  const bool is_short = open_.front().psdu.size() <= timing::sifs_psdu_max;
  free_from_ = std::max(free_from_, now + (is_short ? timing::sifs : timing::lifs));
}

/// The frame at the head of the queue.
void mac::take_up(instant now, random_stream& rng) {
  train_end_ = now + train_; // for a busy channel; its first copy begins it anew
  attempt(now, rng);
}

void mac::attempt(instant now, random_stream& rng) {
  busy_ = 0;
  rounds_ = 0;
  begin(now, rng);
}

/// The next back-off, as soon as the transceiver is free.
void mac::begin(instant now, random_stream& rng) {
  const auto from = std::max(now, free_from_);
  if (!open_.front().in_slot) {
    back_off(from, rng);
    return;
  }
  state_ = state::backing_off;
  // A chip that looks back must not see its own exchange.
  deadline_ = std::max(from + rules_->assessment, assess_from_ + timing::cca);
}

void mac::back_off(instant from, random_stream& rng) {
  const auto& window = rules_->backoffs[std::min<std::size_t>(busy_, rules_->backoffs.size() - 1)];
  const auto steps = static_cast<duration::rep>(rng.below(window.count));
  state_ = state::backing_off;
  deadline_ = from + window.first + steps * window.step + rules_->assessment;
}

/// The next copy of a train, soon; unless it has lasted long enough.
mac_action mac::again(instant now, random_stream& rng) {
  if (train_is_over(now))
    return end_train(now, rng);
  busy_ = 0;
  const auto steps = static_cast<duration::rep>(rng.below(copy_backoff.count));
  state_ = state::backing_off;
  deadline_ = std::max(now, free_from_) + copy_backoff.first + steps * copy_backoff.step +
              rules_->assessment;
  return {};
}

mac_action mac::end_train(instant now, random_stream& rng) {
  const auto& x = open_.front();
  if (x.transmissions == 0)
    return finish(send_status::channel_access_failure, now, rng);
  return finish(x.content.ack_request ? send_status::no_ack : send_status::sent, now, rng);
}

mac_action mac::finish(send_status status, instant now, random_stream& rng) {
  const auto x = open_.pop();
  state_ = state::idle;
  deadline_.reset();
  if (!open_.empty())
    take_up(now, rng);
  return {.transmit = false,
          .ended = finished{x.token, status, counted(x.transmissions), x.arrived, x.last, x.from,
                            status == send_status::sent && x.content.ack_request}};
}

} // namespace rubicon::radio
