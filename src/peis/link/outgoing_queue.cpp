#include "peis/link/outgoing_queue.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::peis {

void message_octets::append(std::size_t offset, std::size_t count, bytes& out) const {
  assert(offset + count <= size());
  const auto from_head = std::min(count, head.size() - std::min(offset, head.size()));
  if (from_head > 0) {
    const auto part = head.view().subspan(offset, from_head);
    out.insert(out.end(), part.begin(), part.end());
  }
  if (count > from_head) {
    const auto part = body.view().subspan(offset + from_head - head.size(), count - from_head);
    out.insert(out.end(), part.begin(), part.end());
  }
}

void encode(const outgoing_package& x, std::uint32_t counter, bytes& out) {
  auto header = x.header;
  header.counter = counter;
  header.length = static_cast<std::uint16_t>(x.length());
  encode(header, out);
  x.content->append(x.offset, x.length(), out);
}

namespace {

constexpr std::size_t control_divisor = 4; ///< of the octets of all other classes

} // namespace

cause outgoing_queue::admission(lane where, std::size_t count, std::size_t octets, link_id origin,
                                random_stream& rng) const {
  const auto& x = classes_[static_cast<std::size_t>(where)];
  if (x.depth + count > limits_.packages)
    return cause::queue_full;
  if (where == lane::control) {
    const bool fits = control_octets_ + octets <= limits_.octets / control_divisor;
    return fits ? cause::none : cause::queue_full;
  }
  if (!has_memory(octets))
    return cause::queue_full;
  const auto held = held_by(x, origin);
  if (origin != own_origin && held + count > limits_.packages - x.depth)
    return cause::queue_full;
  const auto used = static_cast<double>(at_or_above(where)) / static_cast<double>(limits_.packages);
  const bool modest = held * x.streams.size() < x.depth;
  return used > 0.5 && !modest && rng.chance(2 * (used - 0.5)) ? cause::early_drop : cause::none;
}

bool outgoing_queue::has_room(lane where) const {
  std::size_t own = 0;
  for (auto i = static_cast<std::size_t>(lane::acknowledgements);
       i <= static_cast<std::size_t>(where); ++i)
    own += held_by(classes_[i], own_origin);
  return 2 * own < limits_.packages && depth(where) < limits_.packages &&
         has_memory(header_size + data_max);
}

void outgoing_queue::note_pushed(std::size_t index, std::size_t octets) {
  const bool control = index == static_cast<std::size_t>(lane::control);
  (control ? control_octets_ : octets_) += octets;
  if (memory_ && !control)
    memory_->octets += octets;
}

void outgoing_queue::note_popped(std::size_t index, std::size_t octets) {
  const bool control = index == static_cast<std::size_t>(lane::control);
  (control ? control_octets_ : octets_) -= octets;
  if (memory_ && !control)
    memory_->octets -= octets;
}

void outgoing_queue::push(lane where, outgoing_package x, link_id origin) {
  const auto index = static_cast<std::size_t>(where);
  auto& to = classes_[index];
  note_pushed(index, header_size + x.length());
  ++to.depth;
  ++size_;
  for (auto& each : to.streams) {
    if (each.origin == origin) {
      each.packages.push_back(std::move(x));
      return;
    }
  }
  to.streams.push_back({origin, {}});
  to.streams.back().packages.push_back(std::move(x));
}

std::optional<outgoing_package> outgoing_queue::pop() {
  for (std::size_t index = 0; index < lanes; ++index) {
    auto& from = classes_[index];
    if (from.depth == 0)
      continue;
    auto& next = from.streams[from.turn];
    auto x = std::move(next.packages.front());
    next.packages.pop_front();
    if (next.packages.empty())
      from.streams.erase(from.streams.begin() + static_cast<std::ptrdiff_t>(from.turn));
    else
      ++from.turn;
    if (from.turn >= from.streams.size())
      from.turn = 0;
    --from.depth;
    --size_;
    note_popped(index, header_size + x.length());
    return x;
  }
  return std::nullopt;
}

std::size_t outgoing_queue::held_by(const service_class& x, link_id origin) {
  for (const auto& each : x.streams) {
    if (each.origin == origin)
      return each.packages.size();
  }
  return 0;
}

/// Packages in this class and the classes above it, control left out.
std::size_t outgoing_queue::at_or_above(lane where) const {
  std::size_t sum = 0;
  for (auto i = static_cast<std::size_t>(lane::acknowledgements);
       i <= static_cast<std::size_t>(where); ++i)
    sum += classes_[i].depth;
  return sum;
}

} // namespace rubicon::peis
