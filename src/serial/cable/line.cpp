#include "serial/cable/line.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/account/message_ledger.hpp"

namespace rubicon::serial {

std::string to_string(direction x) {
  switch (x) {
  case direction::to_pc:
    return "to_pc";
  case direction::to_mote:
    return "to_mote";
  }
  return "unknown";
}

line::line(line_config config, random_stream rng) : config_(config), rng_(rng) {
  assert(config_.baud > 0);
}

void line::send(direction towards, payload octets, instant now) {
  auto& lane = of(towards);
  const auto size = octets.size();
  lane.counters.written += size;
  if (!plugged_) {
    lane.counters.unplugged += size;
    note_loss(loss::line_failed);
    return;
  }
  const auto accepted = std::min(size, room(lane, now));
  lane.counters.overflow += size - accepted;
  if (accepted < size)
    note_loss(loss::line_failed);
  if (accepted == 0)
    return;
  lane.free_at = std::max(lane.free_at, now) + transmission_time(accepted, config_.baud);
  lane.chunks.push_back({carry(std::move(octets), accepted, lane.counters), lane.free_at});
}

line_outputs line::on_time(instant now) {
  line_outputs out;
  while (const auto next = deadline()) {
    if (*next > now)
      break;
    // At equal times the PC's end comes first, so that the order never depends on the caller.
    const auto towards = !lanes_[0].chunks.empty() && lanes_[0].chunks.front().due == *next
                             ? direction::to_pc
                             : direction::to_mote;
    auto& lane = of(towards);
    lane.counters.arrived += lane.chunks.front().octets.size();
    auto& first = lane.chunks.front();
    out.push_back({towards, std::move(first.octets), first.from});
    lane.chunks.pop_front();
  }
  return out;
}

std::optional<instant> line::deadline() const {
  std::optional<instant> first;
  for (const auto& lane : lanes_)
    if (!lane.chunks.empty())
      first = earliest(first, lane.chunks.front().due);
  return first;
}

line_outputs line::unplug(instant now) {
  auto out = on_time(now);
  plugged_ = false;
  for (auto& lane : lanes_) {
    for (const auto& chunk : lane.chunks) {
      lane.counters.unplugged += chunk.octets.size();
      note_loss(chunk.from, loss::line_failed);
    }
    lane.chunks.clear();
    lane.free_at = now;
  }
  return out;
}

std::size_t line::in_flight(direction towards) const {
  std::size_t octets = 0;
  for (const auto& chunk : lanes_[static_cast<std::size_t>(towards)].chunks)
    octets += chunk.octets.size();
  return octets;
}

const line_counters& line::counters(direction towards) const {
  return lanes_[static_cast<std::size_t>(towards)].counters;
}

line::lane_state& line::of(direction towards) {
  return lanes_[static_cast<std::size_t>(towards)];
}

std::size_t line::room(const lane_state& x, instant now) const {
  constexpr std::int64_t per_octet = 10 * std::nano::den; // backlog in ns times baud
  const auto backlog = std::max(x.free_at - now, duration{});
  const auto waiting =
      static_cast<std::size_t>((backlog.count() * config_.baud + per_octet - 1) / per_octet);
  return config_.buffer - std::min(waiting, config_.buffer);
}

payload line::carry(payload octets, std::size_t accepted, line_counters& counters) {
  if (config_.octet_error <= 0 && accepted == octets.size())
    return octets;
  auto copy = to_bytes(octets.view().first(accepted));
  for (auto& octet : copy) {
    if (!rng_.chance(config_.octet_error))
      continue;
    octet = static_cast<std::uint8_t>(octet ^ (1 + rng_.below(255)));
    ++counters.corrupted;
    note_loss(loss::line_failed);
  }
  return copy;
}

} // namespace rubicon::serial
