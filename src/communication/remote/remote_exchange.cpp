#include "communication/remote/remote_exchange.hpp"

#include <algorithm>

namespace rubicon::communication {

status remote_exchange::refuse() {
  ++counters_.refused;
  return FAIL;
}

bool remote_exchange::may_send() {
  if (self_)
    return true;
  ++counters_.before_join;
  return false;
}

bool remote_exchange::has_room() {
  if (commands_in_flight() < commands_max_)
    return true;
  ++counters_.no_room;
  return false;
}

void remote_exchange::dispatch() {
  if (std::exchange(dispatching_, true))
    return;
  while (!events_.empty() && program_ != nullptr) {
    const auto next = std::move(events_.front());
    events_.pop_front(); // before the program leaves from within it
    next(*program_);
  }
  events_.clear();
  dispatching_ = false;
}

void remote_exchange::on_batch(std::uint64_t taken, std::size_t count) {
  commands_taken_ = std::min(taken, commands_sent_);
  events_received_ += count;
}

std::optional<remote::commands_batch> remote_exchange::take_batch() {
  if (commands_.empty() && events_acked_ == events_received_)
    return std::nullopt;
  commands_sent_ += commands_.size();
  events_acked_ = events_received_;
  return remote::commands_batch{events_received_, std::exchange(commands_, {})};
}

std::size_t remote_exchange::commands_in_flight() const {
  return static_cast<std::size_t>(commands_sent_ - commands_taken_) + commands_.size();
}

mote_address resolved(const remote_exchange& exchange, mote_address x, island_id own) {
  const auto& self = exchange.address();
  if (!self)
    return x;
  if (x.island == own_island)
    x.island = own == own_island ? self->island : own;
  if (x.mote == own_mote)
    x.mote = self->mote;
  return x;
}

} // namespace rubicon::communication
