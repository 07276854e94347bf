#include "network/channels/hop_queue.hpp"

#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"

namespace rubicon::network {

namespace {

/// Of a packet; control messages take no more than their place in the queue.
std::size_t data_octets(const channel_message& x) {
  const auto* data = std::get_if<data_message>(&x.content);
  return data ? data->content.size() : 0;
}

} // namespace

bool hop_queue::has_room(std::size_t octets) const {
  auto sum = octets + (in_flight_ ? data_octets(in_flight_->message) : 0);
  for (const auto& x : waiting_)
    sum += data_octets(x.message);
  return waiting_.size() < packets_max_ && sum <= octets_max_;
}

hop_queue::outcome hop_queue::add(mote_id next, channel_message message, instant due,
                                  departure how) {
  const auto says_the_same = [&](const waiting_hop& x) {
    return x.next == next && x.message.channel == message.channel &&
           std::holds_alternative<end_message>(x.message.content);
  };
  if (std::holds_alternative<end_message>(message.content) &&
      std::ranges::any_of(waiting_, says_the_same))
    return outcome::repeated; // strays come faster than radios wake up
  if (is_data(message) && !has_room(data_octets(message))) {
    note_loss(loss::queue_full);
    return outcome::lost;
  }
  if (waiting_.size() >= 2 * packets_max_)
    return outcome::crowded_out;
  waiting_.push_back({next, std::move(message), 0, due, how});
  return outcome::queued;
}

/// When it may be handed out.
instant hop_queue::due(const waiting_hop& x) const {
  const bool waits = x.how == departure::in_turn || x.rounds > 0;
  return waits ? std::max(x.due, held_until_) : x.due;
}

std::optional<channel_hop> hop_queue::take(instant now) {
  if (in_flight_)
    return std::nullopt;
  const auto next =
      std::ranges::find_if(waiting_, [&](const waiting_hop& x) { return due(x) <= now; });
  if (next == waiting_.end())
    return std::nullopt;
  in_flight_ = std::move(*next);
  waiting_.erase(next);
  const bool in_slot = in_flight_->how == departure::in_slot && in_flight_->rounds == 0;
  const acting_on its(in_flight_->from);
  return channel_hop{in_flight_->next, encode(in_flight_->message), in_slot};
}

std::optional<waiting_hop> hop_queue::on_sent() {
  auto x = std::exchange(in_flight_, std::nullopt);
  if (x)
    ++x->rounds;
  return x;
}

void hop_queue::repeat(waiting_hop x, instant due) {
  x.due = due;
  waiting_.insert(waiting_.begin(), std::move(x));
}

void hop_queue::drop(channel_id channel) {
  std::erase_if(waiting_, [channel](const waiting_hop& x) {
    const bool goes = x.message.channel == channel;
    if (goes)
      note_loss(x.from, loss::channel_lost);
    return goes;
  });
}

void hop_queue::drop_flood(channel_id channel) {
  std::erase_if(waiting_, [channel](const waiting_hop& x) {
    return x.message.channel == channel && x.next == broadcast_mote;
  });
}

std::optional<instant> hop_queue::deadline() const {
  std::optional<instant> next;
  if (!in_flight_)
    for (const auto& x : waiting_)
      next = earliest(next, due(x));
  return next;
}

} // namespace rubicon::network
