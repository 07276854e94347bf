#include "network/frames/outgoing_frames.hpp"

#include <utility>

#include "core/account/provenance.hpp"
#include "network/am.hpp"

namespace rubicon::network {

frame_out outgoing_frames::make(frame_purpose why, mote_id to, std::uint8_t am_type,
                                bytes payload) {
  return {tokens_.issue(why), to, am_type, std::move(payload), std::nullopt};
}

void outgoing_frames::send(frame_out x, const neighbours& links, router_outputs& out) {
  if (x.next_hop != broadcast_mote) {
    tokens_.on_unicast(x.token, x.next_hop);
    x.over = links.has_backbone(x.next_hop) ? medium::backbone : medium::radio;
    out.emplace_back(std::move(x));
    return;
  }
  for (const auto end : backbone_.motes) {
    frame_out copy{no_token, end, x.am_type, x.payload, std::nullopt};
    copy.over = medium::backbone;
    out.emplace_back(std::move(copy));
  }
  out.emplace_back(std::move(x));
}

void outgoing_frames::send(hop x, const neighbours& links, router_outputs& out) {
  const acting_on its(x.from);
  auto frame = make(frame_purpose::packet, x.next, x.am_type, std::move(x.octets));
  frame.in_slot = x.in_slot;
  send(std::move(frame), links, out);
}

void outgoing_frames::send(channel_hop x, const neighbours& links, router_outputs& out) {
  const acting_on its(x.from);
  auto frame = make(frame_purpose::channel, x.next, am::channel, std::move(x.octets));
  frame.in_slot = x.in_slot;
  send(std::move(frame), links, out);
}

} // namespace rubicon::network
