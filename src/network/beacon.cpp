#include "network/beacon.hpp"

#include <algorithm>
#include <cassert>

#include "core/codec.hpp"

namespace rubicon::network {

std::uint16_t quarters(duration x) {
  const auto rounded_up = (x + 250ms - 1ns) / duration(250ms);
  return static_cast<std::uint16_t>(std::clamp<duration::rep>(rounded_up, 0, 65535));
}

link_report beacon::report(mote_id source, mote_id self, bool has_route) const {
  link_report x;
  x.source = source;
  x.sequence = sequence;
  x.next = next_quarters * 250ms;
  const auto ours = std::ranges::find(heard, self, &neighbours::heard_entry::mote);
  if (ours != heard.end())
    x.hears_us = ours->quality;
  x.is_crowded = heard.size() >= crowd;
  x.is_sink = gradient.root == source;
  x.matters = x.is_sink || has_route != (gradient.cost != etx_infinite);
  return x;
}

bytes encode(const beacon& x) {
  assert(x.heard.size() <= beacon::heard_max(x.clock));
  byte_writer out(frame_payload_max);
  out.big(x.sequence).big(x.next_quarters);
  x.gradient.write(out);
  x.coordinates.write(out);
  write(out, x.clock);
  for (const auto& entry : x.heard)
    out.big(entry.mote.value).octet(entry.quality);
  return out.finish();
}

result<beacon> decode_beacon(byte_view octets) {
  if (octets.size() > frame_payload_max)
    return errc::too_long;
  byte_reader in(octets);
  beacon x;
  x.sequence = in.big<std::uint16_t>();
  x.next_quarters = in.big<std::uint16_t>();
  x.gradient = gradient_part::read(in);
  x.coordinates = coordinates_part::read(in);
  x.clock = read_clock_stamp(in);
  x.heard.reserve(in.remaining() / 3);
  while (in.ok() && in.remaining() > 0) {
    const mote_id mote{in.big<std::uint16_t>()};
    x.heard.push_back({mote, in.octet()});
    if (in.ok() && (mote.value == 0 || mote.value > mote_id_max))
      return errc::bad_value;
  }
  if (!in.ok())
    return errc::truncated;
  return x;
}

} // namespace rubicon::network
