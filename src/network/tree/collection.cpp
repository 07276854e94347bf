#include "network/tree/collection.hpp"

#include <algorithm>
#include <cassert>

#include "core/account/message_ledger.hpp"
#include "network/am.hpp"

namespace rubicon::network {

namespace {

std::size_t octets_of(const std::variant<up_packet, down_packet, flood_packet>& packet) {
  const auto* down = std::get_if<down_packet>(&packet);
  const auto route = down ? down->hops.size() * sizeof(mote_id::rep) : 0;
  return route + std::visit([](const auto& x) { return x.content.size(); }, packet);
}

} // namespace

collection::collection(collection_config config, random_stream rng)
    : config_(config), rng_(rng), routes_(config.self),
      sequence_(static_cast<std::uint16_t>(rng_.next())) {
  if (config_.is_root)
    cost_ = 0;
}

std::optional<std::size_t> collection::room_down(mote_id to) const {
  const auto hops = routes_.route_to(to);
  if (!hops || hops->empty())
    return std::nullopt;
  return frame_payload_max - header_size(*hops);
}

collection_outputs collection::send_up(bytes content, instant now, bool in_slot) {
  assert(!config_.is_root && content.size() <= room_up());
  ++counters_.originated;
  enqueue({up_packet{config_.self, parent_, sequence_++, cost_, 0, std::move(content)}, 0, now,
           in_slot});
  collection_outputs out;
  pump(out, now);
  return out;
}

collection_outputs collection::send_down(mote_id to, bytes content, instant now) {
  ++counters_.originated;
  auto hops = routes_.route_to(to);
  collection_outputs out;
  if (!hops || hops->empty() || content.size() + header_size(*hops) > frame_payload_max) {
    ++counters_.no_route;
    note_loss(loss::no_route);
    return out;
  }
  enqueue({down_packet{sequence_++, 0, *std::move(hops), std::move(content)}, 0, now});
  pump(out, now);
  return out;
}

collection_outputs collection::send_to_all(bytes content, instant now) {
  assert(content.size() <= room_flood());
  ++counters_.originated;
  const auto sequence = sequence_++;
  static_cast<void>(is_new({am::flood, config_.self, sequence, 0}));
  enqueue({flood_packet{config_.self, sequence, 0, std::move(content)}, 0, now});
  collection_outputs out;
  pump(out, now);
  return out;
}

collection_outputs collection::on_frame(mote_id, std::uint8_t am_type, byte_view octets,
                                        instant now) {
  collection_outputs out;
  const auto handle = [&](auto decoded) {
    if (decoded) {
      take(*std::move(decoded), out, now);
    } else {
      ++counters_.malformed;
      note_loss(loss::malformed);
    }
  };
  if (am_type == am::up)
    handle(decode_up(octets));
  else if (am_type == am::down)
    handle(decode_down(octets));
  else if (am_type == am::flood)
    handle(decode_flood(octets));
  pump(out, now);
  return out;
}

void collection::take(up_packet x, collection_outputs& out, instant now) {
  // To the root copies over several parents are one packet.
  if (config_.is_root ? !arrived_.take(x.origin, x.sequence)
                      : !is_new({am::up, x.origin, x.sequence, x.hops})) {
    ++counters_.duplicates;
    note_loss(loss::duplicate);
    return;
  }
  ++x.hops;
  if (config_.is_root) {
    routes_.learn(x.origin, x.parent);
    ++counters_.arrived;
    out.emplace_back(collected{x.origin, false, std::move(x.content)});
    return;
  }
  if (x.cost <= cost_ && cost_ != etx_infinite) {
    ++counters_.loops;
    loop_seen_ = true;
  }
  if (x.hops >= config_.hops_max) {
    ++counters_.too_far;
    note_loss(loss::too_far);
    return;
  }
  ++counters_.forwarded;
  enqueue({std::move(x), 0, now});
}

void collection::take(down_packet x, collection_outputs& out, instant now) {
  if (x.hops[x.at] != config_.self) {
    ++counters_.malformed;
    return;
  }
  if (!is_new({am::down, x.hops.back(), x.sequence, x.at})) {
    ++counters_.duplicates;
    note_loss(loss::duplicate);
    return;
  }
  if (x.at + 1U == x.hops.size()) {
    ++counters_.arrived;
    out.emplace_back(collected{mote_id{}, false, std::move(x.content)});
    return;
  }
  ++x.at;
  ++counters_.forwarded;
  enqueue({std::move(x), 0, now});
}

void collection::take(flood_packet x, collection_outputs& out, instant now) {
  if (!is_new({am::flood, x.origin, x.sequence, 0})) {
    ++counters_.duplicates;
    note_loss(loss::duplicate);
    return;
  }
  ++counters_.arrived;
  out.emplace_back(collected{x.origin, true, x.content});
  if (++x.hops >= config_.hops_max) {
    ++counters_.too_far;
    return;
  }
  ++counters_.forwarded;
  enqueue({std::move(x), 0, now + rng_.between(0s, config_.flood_spread)});
}

/// Of all that is kept here, without headers. A route down is content too.
std::size_t collection::octets() const {
  const auto of = [](const waiting& x) { return octets_of(x.packet); };
  auto sum = in_flight_ ? of(*in_flight_) : 0;
  for (const auto& x : queue_)
    sum += of(x);
  return sum;
}

/// What the Network modules say to the sink comes again: it gives way to what users send.
bool collection::gives_way(const waiting& x) {
  const auto* up = std::get_if<up_packet>(&x.packet);
  return up != nullptr && !up->content.empty() && up->content.front() != 0;
}

void collection::enqueue(waiting x) {
  if (queue_.size() >= config_.queue_max && !gives_way(x)) {
    const auto first = std::ranges::find_if(queue_, gives_way);
    if (first != queue_.end()) {
      note_loss(first->from, loss::queue_full);
      queue_.erase(first);
      ++counters_.queue_full;
    }
  }
  if (queue_.size() >= config_.queue_max || octets() + octets_of(x.packet) > config_.octets_max) {
    ++counters_.queue_full;
    note_loss(x.from, loss::queue_full);
  } else {
    queue_.push_back(std::move(x));
  }
}

/// Remembers it. @returns false if it was remembered already
bool collection::is_new(const mark& x) {
  if (std::ranges::find(seen_, x) != seen_.end())
    return false;
  seen_.push_back(x);
  if (seen_.size() > config_.seen_max)
    seen_.erase(seen_.begin());
  return true;
}

/// The next frame of a packet as things are now; nothing while there is no route up.
std::optional<hop> collection::hop_of(waiting& x) const {
  if (const auto* down = std::get_if<down_packet>(&x.packet))
    return hop{down->hops[down->at], am::down, encode(*down)};
  if (const auto* flood = std::get_if<flood_packet>(&x.packet))
    return hop{broadcast_mote, am::flood, encode(*flood)};
  if (parent_ == no_mote)
    return std::nullopt;
  auto& up = std::get<up_packet>(x.packet);
  up.cost = cost_;
  if (up.origin == config_.self)
    up.parent = parent_;
  return hop{parent_, am::up, encode(up)};
}

/// When a packet may be handed out.
instant collection::due(const waiting& x) const {
  return x.in_slot && x.rounds == 0 ? x.due : std::max(x.due, held_until_);
}

/// Hands out the first packet that is due, unless one is in flight.
void collection::pump(collection_outputs& out, instant now) {
  for (auto x = queue_.begin(); x != queue_.end() && !in_flight_;) {
    if (due(*x) > now) {
      ++x;
      continue;
    }
    const acting_on its(x->from);
    if (auto frame = hop_of(*x)) {
      frame->in_slot = x->in_slot && x->rounds == 0;
      in_flight_ = std::move(*x);
      queue_.erase(x);
      out.emplace_back(*std::move(frame));
      return;
    }
    if (++x->rounds >= config_.rounds_max) {
      ++counters_.no_route;
      note_loss(x->from, loss::no_route);
      x = queue_.erase(x);
    } else {
      x->due = now + config_.route_wait;
      ++x;
    }
  }
}

duration collection::pause_after(unsigned rounds) {
  return rng_.between(config_.pause, 2 * config_.pause) * rounds;
}

collection_outputs collection::on_sent(bool acked, instant now) {
  collection_outputs out;
  if (!in_flight_)
    return out;
  auto x = *std::exchange(in_flight_, std::nullopt);
  ++x.rounds;
  const bool is_flood = std::holds_alternative<flood_packet>(x.packet);
  const auto rounds_max = is_flood ? config_.flood_copies : config_.rounds_max;
  const bool over = is_flood ? x.rounds >= rounds_max : acked || x.rounds >= rounds_max;
  if (!over) {
    ++counters_.repeated;
    x.due = now + (is_flood ? config_.flood_spread + rng_.between(0s, config_.flood_spread)
                            : pause_after(x.rounds));
    queue_.insert(queue_.begin(), std::move(x));
  } else if (is_flood) {
    note_loss(x.from, loss::not_received);
  } else if (!acked) {
    ++counters_.gave_up;
    note_loss(x.from, loss::gave_up);
  }
  pump(out, now);
  return out;
}

collection_outputs collection::on_route(mote_id parent, etx_cost cost, instant now) {
  collection_outputs out;
  if (config_.is_root)
    return out;
  cost_ = cost;
  if (parent == std::exchange(parent_, parent))
    return out;
  for (auto& x : queue_) {
    if (parent_ != no_mote && std::holds_alternative<up_packet>(x.packet))
      x.due = std::min(x.due, now);
  }
  pump(out, now);
  return out;
}

collection_outputs collection::on_time(instant now) {
  collection_outputs out;
  pump(out, now);
  return out;
}

std::optional<instant> collection::deadline() const {
  if (in_flight_)
    return std::nullopt;
  std::optional<instant> next;
  for (const auto& x : queue_)
    next = earliest(next, due(x));
  return next;
}

} // namespace rubicon::network
