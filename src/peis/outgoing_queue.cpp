#include "peis/outgoing_queue.hpp"

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

cause outgoing_queue::admission(lane where, std::size_t count, random_stream& dice) const {
  if (depth(where) + count > capacity_)
    return cause::queue_full;
  if (where == lane::control)
    return cause::none;
  const auto used = static_cast<double>(at_or_above(where)) / static_cast<double>(capacity_);
  return used > 0.5 && dice.chance(2 * (used - 0.5)) ? cause::early_drop : cause::none;
}

bool outgoing_queue::has_room(lane where) const {
  return 2 * at_or_above(where) < capacity_;
}

void outgoing_queue::push(lane where, outgoing_package x) {
  packages_[static_cast<std::size_t>(where)].push_back(std::move(x));
  ++size_;
}

std::optional<outgoing_package> outgoing_queue::pop() {
  for (auto& waiting : packages_) {
    if (!waiting.empty()) {
      auto x = std::move(waiting.front());
      waiting.pop_front();
      --size_;
      return x;
    }
  }
  return std::nullopt;
}

/// Packages in this class and the classes above it, control left out.
std::size_t outgoing_queue::at_or_above(lane where) const {
  std::size_t sum = 0;
  for (auto i = static_cast<std::size_t>(lane::acknowledgements);
       i <= static_cast<std::size_t>(where); ++i)
    sum += packages_[i].size();
  return sum;
}

} // namespace rubicon::peis
