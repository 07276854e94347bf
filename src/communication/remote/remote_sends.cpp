#include "communication/remote/remote_sends.hpp"

#include <algorithm>
#include <utility>

namespace rubicon::communication {

std::optional<std::uint32_t> remote_sends::send(mote_address to, byte_view octets, bool reliable,
                                                std::uint8_t am_type) {
  const bool is_valid = to.island.value > 0 && to.mote != mote_id{} &&
                        octets.size() <= exchange_.node().payload_max &&
                        !(reliable && to.mote == broadcast_mote);
  if (!exchange_.may_send() || !is_valid ||
      (reliable && sends_.size() >= exchange_.node().sends_max) || !exchange_.has_room()) {
    exchange_.refuse();
    return std::nullopt;
  }
  const auto number = ++last_number_;
  if (reliable)
    sends_.push_back({number, {}});
  exchange_.command(remote::send_message{number, to, payload(to_bytes(octets)), reliable, am_type});
  return number;
}

status remote_sends::provide(std::uint8_t am_type) {
  if (types_.contains(am_type))
    return SUCCESS;
  if (!exchange_.has_room())
    return exchange_.refuse();
  types_.insert(am_type);
  exchange_.command(remote::provide_type{am_type});
  return SUCCESS;
}

void remote_sends::hold(std::uint8_t am_type) {
  if (types_.contains(am_type))
    held_.insert(am_type);
}

void remote_sends::release(std::uint8_t am_type) {
  held_.erase(am_type);
}

void remote_sends::command_holds() {
  for (const auto x : types_) {
    const bool holds = held_.contains(x);
    if (holds == held_at_node_.contains(x))
      continue;
    exchange_.command(remote::hold_type{x, holds});
    if (holds)
      held_at_node_.insert(x);
    else
      held_at_node_.erase(x);
  }
}

void remote_sends::apply(const remote::send_ended& x) {
  const auto found = std::ranges::find(sends_, x.number, &pending_send::number);
  if (found == sends_.end())
    return;
  found->acked = x.acked;
  exchange_.notify([x](auto& y) { y.ackOf(x.number, status_of(x.acked)); });
  for (; !sends_.empty() && sends_.front().acked; sends_.pop_front())
    exchange_.notify([acked = *sends_.front().acked](auto& y) { y.ack(status_of(acked)); });
}

void remote_sends::apply(const remote::message_received& x) {
  exchange_.notify([x](auto& y) { y.receiveFrom(x.source, x.octets.view(), x.am_type); });
}

void remote_sends::apply(const remote::type_refused& x) {
  types_.erase(x.am_type);
  held_.erase(x.am_type);
  held_at_node_.erase(x.am_type);
  exchange_.notify([am_type = x.am_type](auto& y) { y.receive(0, 0, {}, am_type, FAIL); });
}

} // namespace rubicon::communication
