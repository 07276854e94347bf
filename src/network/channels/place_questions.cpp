#include "network/channels/place_questions.hpp"

#include <cassert>

namespace rubicon::network {

void place_questions::add(const awaited_channel& x, bool is_asked, instant due) {
  assert(!is_full());
  channels_.push_back({x, due, is_asked ? 1U : 0U});
}

void place_questions::remove(channel_id channel) {
  std::erase_if(channels_, [channel](const question& x) { return x.channel.channel == channel; });
}

std::vector<mote_id> place_questions::take_unasked(instant due) {
  std::vector<mote_id> destinations;
  for (auto& x : channels_) {
    if (x.asks > 0)
      continue;
    x.asks = 1;
    x.due = due;
    destinations.push_back(x.channel.destination);
  }
  return destinations;
}

std::vector<awaited_channel> place_questions::on_answer(mote_id destination, bool is_useless,
                                                        instant now) {
  std::vector<awaited_channel> ready;
  for (auto x = channels_.begin(); x != channels_.end();) {
    const bool is_answered = x->channel.destination == destination;
    if (is_answered && !(is_useless && may_ask_again(*x, true))) {
      ready.push_back(x->channel);
      x = channels_.erase(x);
      continue;
    }
    if (is_answered)
      x->due = now + gap;
    ++x;
  }
  return ready;
}

std::vector<overdue_channel> place_questions::on_time(bool is_crowd, instant due, instant now) {
  std::vector<overdue_channel> overdue;
  for (auto x = channels_.begin(); x != channels_.end();) {
    if (x->due > now) {
      ++x;
      continue;
    }
    const bool is_asked = may_ask_again(*x, is_crowd);
    overdue.push_back({x->channel, is_asked});
    if (!is_asked) {
      x = channels_.erase(x);
      continue;
    }
    ++x->asks;
    x->due = due;
    ++x;
  }
  return overdue;
}

std::optional<instant> place_questions::deadline() const {
  std::optional<instant> next;
  for (const auto& x : channels_)
    next = earliest(next, x.due);
  return next;
}

} // namespace rubicon::network
