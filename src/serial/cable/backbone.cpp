#include "serial/cable/backbone.hpp"

#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "serial/cable/line_config.hpp"

namespace rubicon::serial {

void backbone::send(backbone_direction to, backbone_packet x, instant now) {
  auto& lane = of(to);
  ++lane.counters.sent;
  if (is_cut_ || lane.packets.size() >= config_.queue) {
    ++(is_cut_ ? lane.counters.cut : lane.counters.overflow);
    lose(to, x, provenance(), now);
    return;
  }
  const auto on_cable = transmission_time(x.octets.size() + overhead, config_.baud);
  const auto waited = std::max(lane.free_at - now, duration{});
  lane.free_at = now + waited + on_cable;
  const auto known = waited + 2 * on_cable + config_.latency;
  const auto more = config_.jitter > 0s ? rng_.between(0s, config_.jitter) : duration{};
  lane.last_due = std::max(lane.last_due, now + known + more);
  lane.packets.push_back({std::move(x), known + config_.jitter / 2, lane.last_due});
}

void backbone::set_end(backbone_direction to, bool on) {
  of(to).is_on = on;
  if (on)
    return;
  const auto from_it = opposite(to);
  std::erase_if(endings_, [from_it](const ending& x) { return x.what.to == from_it; });
  for (auto& x : of(from_it).packets)
    x.packet.token.reset();
}

void backbone::lose(backbone_direction to, const backbone_packet& x, const provenance& from,
                    instant at) {
  note_loss(from, loss::line_failed);
  if (x.token)
    end({to, *x.token, false, from}, at + ack_wait + config_.latency + config_.jitter);
}

void backbone::end(backbone_done x, instant due) {
  const auto at = std::ranges::upper_bound(endings_, due, {}, &ending::due);
  endings_.insert(at, {std::move(x), due});
}

void backbone::arrive(backbone_direction to, backbone_outputs& out) {
  auto& lane = of(to);
  auto x = std::move(lane.packets.front());
  lane.packets.pop_front();
  if (!lane.is_on) {
    ++lane.counters.end_off;
    lose(to, x.packet, x.from, x.due);
    return;
  }
  ++lane.counters.arrived;
  if (x.packet.token)
    end({to, *x.packet.token, true, x.from}, x.due + config_.latency);
  out.emplace_back(
      backbone_arrived{to, x.packet.am_type, std::move(x.packet.octets), x.age, x.from});
}

backbone_outputs backbone::on_time(instant now) {
  backbone_outputs out;
  while (const auto next = deadline()) {
    if (*next > now)
      break;
    // At equal times up comes first, so that the order never depends on the caller.
    bool is_packet = false;
    for (const auto to : {backbone_direction::up, backbone_direction::down}) {
      const auto& packets = of(to).packets;
      if (is_packet || packets.empty() || packets.front().due != *next)
        continue;
      is_packet = true;
      arrive(to, out);
    }
    if (is_packet)
      continue;
    out.emplace_back(std::move(endings_.front().what));
    endings_.erase(endings_.begin());
  }
  return out;
}

std::optional<instant> backbone::deadline() const {
  std::optional<instant> first;
  for (const auto& lane : lanes_)
    if (!lane.packets.empty())
      first = earliest(first, lane.packets.front().due);
  if (!endings_.empty())
    first = earliest(first, endings_.front().due);
  return first;
}

backbone_outputs backbone::cut(instant now) {
  auto out = on_time(now);
  is_cut_ = true;
  for (const auto to : {backbone_direction::up, backbone_direction::down}) {
    auto& lane = of(to);
    for (const auto& x : lane.packets) {
      ++lane.counters.cut;
      lose(to, x.packet, x.from, now);
    }
    lane.packets.clear();
    lane.free_at = lane.last_due = now;
  }
  return out;
}

} // namespace rubicon::serial
