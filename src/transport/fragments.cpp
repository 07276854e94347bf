#include "transport/fragments.hpp"

#include <algorithm>
#include <cassert>

namespace rubicon::transport {

std::optional<std::vector<bytes>> cut(byte_view packet, std::size_t room, std::uint8_t tag) {
  assert(room >= 3);
  if (packet.size() + 1 <= room) {
    bytes whole{0};
    whole.insert(whole.end(), packet.begin(), packet.end());
    return std::vector<bytes>{std::move(whole)};
  }
  const auto share = room - 2;
  const auto count = (packet.size() + share - 1) / share;
  if (count > fragments_max)
    return std::nullopt;
  std::vector<bytes> fragments;
  for (std::size_t i = 0; i < count; ++i) {
    const auto content = packet.subspan(i * share, std::min(share, packet.size() - i * share));
    bytes fragment{static_cast<std::uint8_t>(i << 4 | (count - 1)), tag};
    fragment.insert(fragment.end(), content.begin(), content.end());
    fragments.push_back(std::move(fragment));
  }
  return fragments;
}

std::optional<bytes> assembly::on_fragment(mote_id origin, byte_view fragment, instant now) {
  drop_late(now);
  const std::size_t index = fragment.empty() ? 1 : fragment[0] >> 4;
  const std::size_t last = fragment.empty() ? 0 : fragment[0] & 0x0f;
  if (index > last || (last > 0 && fragment.size() < 3)) {
    ++counters_.malformed;
    return std::nullopt;
  }
  if (last == 0)
    return to_bytes(fragment.subspan(1));
  const auto tag = fragment[1];
  auto found = std::ranges::find_if(
      packets_, [&](const packet& x) { return x.origin == origin && x.tag == tag; });
  if (found != packets_.end() && found->fragments.size() != last + 1) { // another one, long after
    packets_.erase(found);
    ++counters_.incomplete;
    found = packets_.end();
  }
  if (found == packets_.end()) {
    if (packets_.size() >= config_.packets_max) {
      packets_.erase(packets_.begin());
      ++counters_.incomplete;
    }
    packets_.push_back({origin, tag, std::vector<std::optional<bytes>>(last + 1), now});
    found = packets_.end() - 1;
  }
  found->last_received = now;
  found->fragments[index] = to_bytes(fragment.subspan(2));
  if (!std::ranges::all_of(found->fragments, [](const auto& x) { return x.has_value(); }))
    return std::nullopt;
  bytes whole;
  for (const auto& x : found->fragments)
    whole.insert(whole.end(), x->begin(), x->end());
  packets_.erase(found);
  return whole;
}

void assembly::drop_late(instant now) {
  counters_.incomplete += std::erase_if(
      packets_, [&](const packet& x) { return x.last_received + config_.patience < now; });
}

} // namespace rubicon::transport
