#include "mote/stack/channel_pacer.hpp"

#include "core/account/message_ledger.hpp"

namespace rubicon::mote {

bool channel_pacer::push(stream::channel_handle channel, instant turn, bytes octets,
                         provenance from) {
  auto& its = waiting_[channel];
  if (its.packets.empty())
    its.due = turn;
  const bool is_full = its.packets.size() >= packets_max;
  if (is_full) {
    note_loss(its.packets.front().second, loss::overtaken);
    its.packets.erase(its.packets.begin());
  }
  its.packets.emplace_back(std::move(octets), std::move(from));
  return is_full;
}

std::optional<instant> channel_pacer::deadline() const {
  std::optional<instant> due;
  for (const auto& [channel, its] : waiting_)
    due = earliest(due, std::optional(its.due));
  return due;
}

} // namespace rubicon::mote
